use formwork::hierarchy::Hierarchy; use formwork::scheme::*; use formwork::topology::*;
#[path = "../tests/common/meshes.rs"] #[allow(dead_code)] mod meshes;
fn main(){
  let tri = std::env::args().nth(1).is_some_and(|a| a=="tri");
  let side: u32 = 100;
  let d = if tri { meshes::cut_grid(side, side/2, false, &vec![1u8;(side*side/2) as usize]) } else { meshes::grid(side,side,false) };
  let cage = Cage::new(d).unwrap();
  let scheme = if tri {Scheme::Loop(Variant::Loop, BoundaryRule::Reflect)} else {Scheme::default()};
  for _ in 0..8 { let h = Hierarchy::new(&cage, scheme, 3).unwrap();
    if std::env::args().nth(2).is_some() { for l in 1..=3 { let p = h.level(l-1).mesh(); std::hint::black_box((h.refinement(l).s1(p), h.refinement(l).s2(p))); } } }
}
