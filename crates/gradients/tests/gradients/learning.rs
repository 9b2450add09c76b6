//! Networks that learn: their derivatives against differences.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_gradients::layers::learning::{By, Kernel, Network};

/// Weights and biases of each layer: kernels of 3 and 1, and a linear layer.
const LENGTHS: [usize; 8] = [4 * 2 * 9, 4, 4 * 4 * 9, 4, 3 * 6, 3, 5 * 3 * 4 * 6, 5];

/// Every kind of layer, of an image of 2 channels, 4 rows and 6 columns.
fn network(lists: &[Vec<f32>], by: By) -> Network {
    let list = |layer: usize| [&lists[2 * layer][..], &lists[2 * layer + 1]];
    let kernel = |size, stride| Kernel {
        size,
        stride,
        padding: size / 2,
    };
    let (mut network, image) = Network::new(2, [4, 6], by);
    let halved = network.convolution(image, kernel(3, 2), list(0));
    let halved = network.relu(halved);
    let added = network.convolution(halved, kernel(3, 1), list(1));
    let sum = network.sum(halved, added);
    let doubled = network.doubled(sum);
    let joined = network.joined(doubled, image);
    let narrow = network.convolution(joined, kernel(1, 1), list(2));
    let open = network.relu(narrow);
    network.linear(open, list(3));
    network
}

/// The sum over images of the outputs by some factors.
fn loss(network: &Network, images: &[Vec<f32>]) -> (f64, Vec<Vec<f32>>) {
    let factors = [0.3, -0.8, 1.1, 0.5, -0.2];
    network.loss_and_derivatives(images, Clone::clone, |_, output| {
        let products = output.iter().zip(factors).map(|(v, f)| f64::from(v * f));
        (products.sum(), factors.to_vec())
    })
}

#[test]
fn derivatives_are_differences() {
    let mut rng = Pcg32::seed_from_u64(7);
    let mut random = |count: usize| Vec::from_iter((0..count).map(|_| rng.random_range(-1.0..1.0_f32)));
    let (mut lists, mut images) = (LENGTHS.map(&mut random), [48; 3].map(&mut random));
    let (_, by_weights) = loss(&network(&lists, By::Weights), &images);
    let (_, by_image) = loss(&network(&lists, By::Image), &images[1..2]);
    assert_eq!(by_weights.iter().map(Vec::len).collect::<Vec<_>>(), LENGTHS);
    let mut compared = 0;
    let mut compare = |found: f32, low: f64, high: f64, step: f64, half: f64| {
        // Between two kinks the network is a line in each number.
        let (wanted, middle) = ((high - low) / (2.0 * step), half - low);
        if (middle / step - wanted).abs() < 1e-3 {
            assert!((f64::from(found) - wanted).abs() < 2e-3, "{found} for {wanted}");
            compared += 1;
        }
    };
    let step = 0.01;
    for (i, list) in by_weights.iter().enumerate() {
        for (j, found) in list.iter().enumerate() {
            let old = lists[i][j];
            let [low, half, high] = [-step, 0.0, step].map(|by| {
                lists[i][j] = old + by;
                loss(&network(&lists, By::Weights), &images).0
            });
            lists[i][j] = old;
            compare(*found, low, high, step.into(), half);
        }
    }
    for (j, found) in by_image[0].iter().enumerate() {
        let old = images[1][j];
        let [low, half, high] = [-step, 0.0, step].map(|by| {
            images[1][j] = old + by;
            loss(&network(&lists, By::Image), &images[1..2]).0
        });
        images[1][j] = old;
        compare(*found, low, high, step.into(), half);
    }
    let all = LENGTHS.iter().sum::<usize>() + 48;
    assert!(10 * compared > 8 * all, "{compared} of {all}");
}
