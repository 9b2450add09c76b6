//! Locates the camera of a photo: `cargo run --release --example locate_a_photo -- PHOTO SCENE.toml CAMERA.yaml`

use std::error::Error;
use std::path::PathBuf;

use scaleproof::{Camera, Photo, Scene, TagDetectorChoice, locate_photo};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [photo, scene, camera] = &arguments[..] else {
        return Err("give a photo, a scene file and a camera file".into());
    };
    let (scene, camera) = (Scene::open(scene)?, Camera::open(camera)?);
    let mut tags = TagDetectorChoice::default().open(&scene.families())?;
    match locate_photo(&Photo::open(photo)?, &scene, &camera, &mut *tags)?.result {
        Ok(located) => {
            let (at, sigma) = (located.viewpoint, located.sigma);
            println!("azimuth {:.2}° ± {:.2}°", at.azimuth_deg, sigma.azimuth_deg);
            println!(
                "pitch {:.2}°, distance {:.0} mm, by {} tags",
                at.pitch_deg,
                at.distance_mm,
                located.tags.len()
            );
        }
        Err(reason) => println!("no pose: {reason}"),
    }
    Ok(())
}
