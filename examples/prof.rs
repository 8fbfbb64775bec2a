use formwork::hierarchy::Hierarchy; use formwork::osd::*; use formwork::scheme::*; use formwork::topology::*; use std::time::Instant;
#[path = "../tests/common/meshes.rs"] #[allow(dead_code)] mod meshes;
fn t<T>(what:&str, f: impl FnOnce()->T)->T{let s=Instant::now(); let r=f(); println!("{what:<40} {:>9.1} ms", s.elapsed().as_secs_f64()*1e3); r}
fn main(){
  let tri = std::env::args().nth(1).is_some_and(|a| a=="tri");
  let side: u32 = std::env::args().nth(2).map_or(100, |a| a.parse().unwrap());
  let d = if tri { meshes::cut_grid(side, side/2, false, &vec![1u8;(side*side/2) as usize]) } else { meshes::grid(side,side,false) };
  let cage = t("cage", || Cage::new(d).unwrap());
  let (scheme, os) = if tri {(Scheme::Loop(Variant::Loop, BoundaryRule::Reflect), OsdScheme::Loop)} else {(Scheme::default(), OsdScheme::Catmark)};
  let mut r = t("refiner", || Refiner::new(&cage, os).unwrap());
  t("refine 3 full", || r.refine_uniform(3).unwrap());
  for l in 1..=3 { t(&format!("stencils {l}"), || r.stencils(l).unwrap()); }
  let mut ms = vec![];
  for l in 0..=3 { ms.push(t(&format!("mesh {l}"), || r.mesh(l).unwrap())); t("tags", || r.tags(l).unwrap()); }
  for l in 0..3 { let m = t("masks", || r.masks(l).unwrap()); let k = scheme.split(&vec![if tri {3} else {4}]).unwrap(); t("homotopy", || scheme.homotopy(k, &ms[l], &m)); }
  let h = t("hierarchy", || Hierarchy::new(&cage, scheme, 3).unwrap());
  for l in 1..=3 { t("operators", || h.operators(l)); }
}
