use formwork::hierarchy::*; use formwork::scheme::*; use formwork::topology::*; use formwork::cochain::Cochain;
#[path = "../tests/common/meshes.rs"] #[allow(dead_code)] mod meshes;
fn main(){
  let tri = std::env::args().nth(1).is_some_and(|a| a=="tri");
  let d = if tri { meshes::cut_grid(70, 70, false, &vec![1u8;4900]) } else { meshes::grid(100,100,false) };
  let cage = Cage::new(d).unwrap();
  let scheme = if tri {Scheme::Loop(Variant::Loop, BoundaryRule::Reflect)} else {Scheme::default()};
  let h = Hierarchy::new(&cage, scheme, 4).unwrap();
  let c = Cochain::<1>::new(vec![1.0; h.level(3).mesh().num_edges()]);
  let (mut o, mut w) = (Cochain::new(vec![]), Workspace::new());
  for i in 0..60 { let s=std::time::Instant::now(); h.refine_into(4, &c, &mut o, &mut w); if i%20==5 {println!("{:?}", s.elapsed());} }
}
