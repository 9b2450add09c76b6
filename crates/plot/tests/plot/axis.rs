use scaleproof_plot::{PlotAxis, Scale, tick_label};

#[test]
fn a_log_axis_holds_its_values_between_round_ends() {
    let axis = PlotAxis::around("ms", Scale::Log, [3.0, 0.0, f64::NAN, 80.0]);
    assert_eq!((axis.low, axis.high), (2.0, 100.0));
    assert_eq!(axis.ticks(), [2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
    assert!((axis.share(2.0), axis.share(100.0), axis.share(0.0)) == (0.0, 1.0, 0.0));
    assert!((axis.share(200f64.sqrt()) - 0.5).abs() < 1e-12);
}

#[test]
fn a_linear_axis_starts_at_zero() {
    let axis = PlotAxis::around("share", Scale::Linear, [0.3, 0.9]);
    assert_eq!((axis.low, axis.high), (0.0, 0.9));
    assert_eq!(
        axis.ticks().iter().map(|v| tick_label(*v)).collect::<Vec<_>>(),
        ["0", "0.2", "0.4", "0.6", "0.8"]
    );
}

#[test]
fn nothing_to_show_is_still_an_axis() {
    for scale in [Scale::Linear, Scale::Log] {
        for values in [vec![], vec![0.0], vec![5.0, 5.0]] {
            let axis = PlotAxis::around("", scale, values);
            assert!(axis.low < axis.high && !axis.ticks().is_empty(), "{axis:?}");
        }
    }
}

#[test]
fn labels_are_short() {
    assert_eq!(
        [0.002, 0.05, 1.0, 20.0, 1500.0, 0.0].map(tick_label),
        ["0.002", "0.05", "1", "20", "1500", "0"]
    );
}
