fn main(){
use spectral_remesh::spectral::ascent::*;
use spectral_remesh::spectral::free::*;
use spectral_remesh::surface::submanifold::*;
use spectral_remesh::base::rng::*;
for sweeps in [10,20,40] { for n in [1024usize]{
 let rmax=(1.0/(2.0*3f64.sqrt()*n as f64)).sqrt();
 let sigma=2.5*0.75*rmax;
 let (mut a,mut b,mut c)=(0.0,0.0,0.0);
 for seed in 0..10u64 {
 let mut rng=stream(seed,Stage::Candidates);
 let mut p:Vec<[f64;2]>=(0..n).map(|_|[unit(&mut rng),unit(&mut rng)]).collect();
 ascend_freely(&FlatTorus,&mut p,Climb{sigma,step:PAPER_STEP,sweeps},&()).unwrap();
 let near:Vec<f64>=p.iter().enumerate().map(|(i,x)| p.iter().enumerate().filter(|q|q.0!=i).map(|(_,y)|{let o=FlatTorus.offset(x,y);(o[0]*o[0]+o[1]*o[1]).sqrt()}).fold(9.0,f64::min)/2.0/rmax).collect();
 let min=near.iter().copied().fold(9.0,f64::min);
 let mean=near.iter().sum::<f64>()/n as f64;
 a+=min/10.0;b+=mean/10.0;c=seed as f64;
 }
 println!("{sweeps} {n} min {a:.4} mean {b:.4} {c}");
}}
}
