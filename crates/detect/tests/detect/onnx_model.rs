//! What is read of ONNX files, beside ONNX Runtime.

use ort::session::Session;
use ort::value::{DynValue, Tensor as OrtTensor};
use scaleproof_detect::onnx_model::{Attribute, Model, Numbers, Tensor};
use scaleproof_detect::{Runtime, darknet_to_onnx};

use crate::common::onnx::{self, Input, bytes, int, step, varint};
use crate::common::{home, shared};

fn session(network: &[u8]) -> Session {
    let environment = &Runtime::load().unwrap().environment;
    let mut builder = Session::builder(environment).unwrap();
    builder.commit_from_memory(network).unwrap()
}

/// A network of one number with some nodes and constants.
fn model(parts: &[Vec<u8>]) -> Vec<u8> {
    onnx::graph(&Input::floats("x", &[1]), parts, &["y"], 17)
}

fn refusal(network: &[u8]) -> String {
    let refusal = Model::read(network).unwrap_err().to_string();
    assert_eq!(refusal.lines().count(), 1, "{refusal}");
    refusal
}

fn initializer(sides: &[u64], element: u64, data: &[u8]) -> Vec<u8> {
    let sides: Vec<u8> = sides.iter().flat_map(|side| int(1, *side)).collect();
    bytes(5, &[sides, int(2, element), bytes(8, b"c"), data.to_vec()].concat())
}

/// Numbers of one element type, in the three ways that a file may hold them.
struct Element {
    number: u64,
    count: usize,
    raw: Vec<u8>,
    /// One by one, and in one field.
    lists: [Vec<u8>; 2],
}

/// Of a type that is listed in `field`, each number as bytes and as what is listed.
fn element<const N: usize>(
    number: u64,
    field: u64,
    wire: u64,
    numbers: impl Iterator<Item = ([u8; N], Vec<u8>)>,
) -> Element {
    let (raw, listed): (Vec<[u8; N]>, Vec<Vec<u8>>) = numbers.unzip();
    let one_by_one = listed
        .iter()
        .flat_map(|v| [varint(field << 3 | wire), v.clone()].concat());
    Element {
        number,
        count: raw.len(),
        lists: [one_by_one.collect(), bytes(field, &listed.concat())],
        raw: raw.concat(),
    }
}

/// As they are listed, small negative numbers take ten bytes.
fn listed(v: i64) -> Vec<u8> {
    varint(v as u64)
}

fn elements() -> Vec<Element> {
    let floats = [0.0_f32, -1.5, 3e38, 1e-40, f32::NEG_INFINITY];
    let whole = [i64::MIN, -129, -1, 0, 7, i64::from(i32::MAX), 1 << 53];
    let bits = || 0..=u16::MAX;
    vec![
        element(
            1,
            4,
            5,
            floats.iter().map(|v| (v.to_le_bytes(), v.to_le_bytes().to_vec())),
        ),
        element(2, 5, 0, (0..=255_u8).map(|v| ([v], listed(v.into())))),
        element(3, 5, 0, (-128..=127_i8).map(|v| (v.to_le_bytes(), listed(v.into())))),
        element(4, 5, 0, bits().map(|v| (v.to_le_bytes(), listed(v.into())))),
        element(5, 5, 0, bits().map(|v| (v.to_le_bytes(), listed((v as i16).into())))),
        element(
            6,
            5,
            0,
            whole
                .iter()
                .map(|v| ((*v as i32).to_le_bytes(), listed((*v as i32).into()))),
        ),
        element(7, 7, 0, whole.iter().map(|v| (v.to_le_bytes(), listed(*v)))),
        element(9, 5, 0, [0, 1, 1, 0].into_iter().map(|v| ([v], listed(v.into())))),
        element(10, 5, 0, bits().map(|v| (v.to_le_bytes(), listed(v.into())))),
        element(
            11,
            10,
            1,
            floats
                .iter()
                .map(|v| (f64::from(*v).to_le_bytes(), f64::from(*v).to_le_bytes().to_vec())),
        ),
        element(
            12,
            11,
            0,
            [0, 7, u32::MAX]
                .into_iter()
                .map(|v| (v.to_le_bytes(), listed(v.into()))),
        ),
        element(
            13,
            11,
            0,
            [0, 7, 1_u64 << 62]
                .into_iter()
                .map(|v| (v.to_le_bytes(), listed(v as i64))),
        ),
        element(16, 5, 0, bits().map(|v| (v.to_le_bytes(), listed(v.into())))),
    ]
}

/// All floats of 16 bits among them.
#[test]
fn every_element_type_is_read_as_onnx_runtime_reads_it() {
    let cast = step("Cast", &["c"], &["y"], &[onnx::whole_attribute("to", 1)]);
    for e in elements() {
        for (way, data) in [bytes(9, &e.raw), e.lists[0].clone(), e.lists[1].clone()]
            .iter()
            .enumerate()
        {
            let network = model(&[initializer(&[e.count as u64], e.number, data), cast.clone()]);
            let tensor = Model::read(&network).unwrap().constants.remove("c").unwrap();
            assert_eq!(tensor.shape, [e.count]);
            let ours: Vec<f32> = match tensor.numbers {
                Numbers::Floats(v) => v,
                Numbers::Whole(v) => v.iter().map(|v| *v as f32).collect(),
            };
            let mut session = session(&network);
            let x = OrtTensor::from_array((vec![1], vec![0.0_f32])).unwrap();
            let outputs = session.run(ort::inputs![x]).unwrap();
            let theirs = outputs[0].try_extract_tensor::<f32>().unwrap().1;
            assert_eq!(theirs.len(), e.count);
            for (i, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let same = ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan());
                assert!(same, "element type {}, way {way}, {i}: {ours}, not {theirs}", e.number);
            }
        }
    }
}

#[test]
fn whole_numbers_above_those_of_64_bits_with_a_sign_are_the_highest() {
    let network = model(&[initializer(&[], 13, &bytes(9, &u64::MAX.to_le_bytes()))]);
    let (shape, numbers) = (Vec::new(), Numbers::Whole(vec![i64::MAX]));
    assert_eq!(Model::read(&network).unwrap().constants["c"], Tensor { shape, numbers });
}

/// What a file says of its inputs and outputs is what ONNX Runtime says, each node's inputs are there before it, and the constants are those of ONNX
/// Runtime, which gives them as outputs of its own.
fn reads_as_onnx_runtime(name: &str, network: &[u8]) {
    let model = Model::read(network).unwrap_or_else(|e| panic!("{name}: {e}"));
    let plain = session(network);
    let inputs: Vec<&str> = plain.inputs().iter().map(|input| input.name()).collect();
    let outputs: Vec<&str> = plain.outputs().iter().map(|output| output.name()).collect();
    assert_eq!(
        (&model.inputs[..], &model.outputs[..]),
        (&owned(&inputs)[..], &owned(&outputs)[..]),
        "{name}"
    );
    let mut known: Vec<&String> = model.inputs.iter().chain(model.constants.keys()).collect();
    for node in &model.nodes {
        let unknown = node
            .inputs
            .iter()
            .find(|input| !input.is_empty() && !known.contains(input));
        assert_eq!(unknown, None, "{name}: {}", node.name);
        known.extend(&node.outputs);
    }
    let constants: Vec<&String> = model
        .constants
        .keys()
        .filter(|name| !model.outputs.contains(name))
        .collect();
    let outputs = constants.iter().flat_map(|name| {
        let element = match model.constants[*name].numbers {
            Numbers::Floats(_) => 1,
            Numbers::Whole(_) => 7,
        };
        let kind = bytes(2, &bytes(1, &int(1, element)));
        bytes(12, &[bytes(1, name.as_bytes()), kind].concat())
    });
    // Two messages in one field are one message (protobuf.dev, "Encoding").
    let with_outputs = [network.to_vec(), bytes(7, &outputs.collect::<Vec<u8>>())].concat();
    let mut session = session(&with_outputs);
    let given = session.inputs().iter().map(|input| {
        let sides = input.dtype().tensor_shape().unwrap();
        let sides: Vec<i64> = sides.iter().map(|side| (*side).max(1)).collect();
        let count = sides.iter().product::<i64>() as usize;
        let value: DynValue = match sides.len() {
            2 => OrtTensor::from_array((sides, vec![320_i64; count])).unwrap().into_dyn(),
            _ => OrtTensor::from_array((sides, vec![0.5_f32; count])).unwrap().into_dyn(),
        };
        (input.name().to_owned(), value)
    });
    let given: Vec<(String, DynValue)> = given.collect();
    let answers = session.run(given).unwrap();
    for constant in &constants {
        let Tensor { shape, numbers } = &model.constants[*constant];
        let (their_shape, is_same) = match numbers {
            Numbers::Floats(v) => {
                let (shape, theirs) = answers[constant.as_str()].try_extract_tensor::<f32>().unwrap();
                (shape, v == theirs)
            }
            Numbers::Whole(v) => {
                let (shape, theirs) = answers[constant.as_str()].try_extract_tensor::<i64>().unwrap();
                (shape, v == theirs)
            }
        };
        let shape: Vec<i64> = shape.iter().map(|side| *side as i64).collect();
        assert!(
            is_same && their_shape[..] == shape,
            "{name}: {constant} {shape:?}, {their_shape:?}"
        );
    }
    println!("{name}: {} nodes, {} constants", model.nodes.len(), constants.len());
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

#[test]
fn networks_are_read_as_onnx_runtime_reads_them() {
    for file in [
        "exported/yolo26.onnx",
        "exported/yolo26_end2end.onnx",
        "exported/rtdetr_v2.onnx",
        "exported/effdet_grids.onnx",
    ] {
        let path = home().join("tests/data").join(file);
        reads_as_onnx_runtime(file, &std::fs::read(path).unwrap());
    }
    let car = home().join("detectors/scaleproof_car.onnx");
    reads_as_onnx_runtime("scaleproof_car", &std::fs::read(car).unwrap());
    let [cfg, weights] = ["cfg", "weights"].map(|ending| home().join(format!("tests/data/cases/darknet/v4.{ending}")));
    reads_as_onnx_runtime("darknet", &darknet_to_onnx(&cfg, &weights).unwrap());
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn shared_networks_are_read_as_onnx_runtime_reads_them() {
    let mut count = 0;
    for folder in ["detectors", "detectors_more"] {
        for file in std::fs::read_dir(shared(folder)).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "onnx") {
                reads_as_onnx_runtime(&path.display().to_string(), &std::fs::read(&path).unwrap());
                count += 1;
            }
        }
    }
    assert!(count >= 12);
}

#[test]
fn nodes_have_their_attributes() {
    let attributes = [
        onnx::whole_attribute("int", -3),
        onnx::float_attribute("float", 0.25),
        onnx::text_attribute("text", "same"),
        onnx::list_attribute("ints", &[1, -1]),
        // Packed.
        [
            bytes(1, b"packed"),
            bytes(8, &[varint(5), varint(300)].concat()),
            int(20, 7),
        ]
        .concat(),
        [
            bytes(1, b"floats"),
            bytes(7, &[1.0_f32, -2.0].map(f32::to_le_bytes).concat()),
            int(20, 6),
        ]
        .concat(),
        [bytes(1, b"texts"), bytes(9, b"a"), bytes(9, b"b"), int(20, 8)].concat(),
        // A writer may leave out zeros.
        [bytes(1, b"zero"), int(20, 2)].concat(),
        [bytes(1, b"none"), int(20, 7)].concat(),
    ];
    let network = model(&[step("Relu", &["x", "", "x"], &["y", "z"], &attributes)]);
    let node = &Model::read(&network).unwrap().nodes[0];
    assert_eq!((node.name.as_str(), node.operator.as_str()), ("Relu_y", "Relu"));
    assert_eq!(
        (&node.inputs[..], &node.outputs[..]),
        (&owned(&["x", "", "x"])[..], &owned(&["y", "z"])[..])
    );
    assert_eq!(
        (node.int("int"), node.int("zero"), node.int("float")),
        (Some(-3), Some(0), None)
    );
    assert_eq!((node.float("float"), node.float("absent")), (Some(0.25), None));
    assert_eq!(
        (node.text("text"), node.ints("ints")),
        (Some("same"), Some(&[1, -1][..]))
    );
    assert_eq!(
        (node.ints("packed"), node.ints("none")),
        (Some(&[5, 300][..]), Some(&[][..]))
    );
    assert_eq!(node.floats("floats"), Some(&[1.0, -2.0][..]));
    assert_eq!(node.attributes["texts"], Attribute::Texts(owned(&["a", "b"])));
}

#[test]
fn constant_nodes_are_constants() {
    let tensor = [
        int(1, 2),
        int(2, 1),
        bytes(9, &[1.0_f32, 2.0].map(f32::to_le_bytes).concat()),
    ]
    .concat();
    let of = |attribute: Vec<u8>| {
        let model = Model::read(&model(&[step("Constant", &[], &["k"], &[attribute])])).unwrap();
        assert!(model.nodes.is_empty());
        model.constants["k"].clone()
    };
    let expected = |shape: &[usize], numbers| Tensor {
        shape: shape.to_vec(),
        numbers,
    };
    let floats = [bytes(1, b"value_floats"), bytes(7, &3.5_f32.to_le_bytes()), int(20, 6)].concat();
    assert_eq!(
        of([bytes(1, b"value"), bytes(5, &tensor), int(20, 4)].concat()),
        expected(&[2], Numbers::Floats(vec![1.0, 2.0]))
    );
    assert_eq!(
        of(onnx::float_attribute("value_float", 3.5)),
        expected(&[], Numbers::Floats(vec![3.5]))
    );
    assert_eq!(of(floats), expected(&[1], Numbers::Floats(vec![3.5])));
    assert_eq!(
        of(onnx::whole_attribute("value_int", -7)),
        expected(&[], Numbers::Whole(vec![-7]))
    );
    assert_eq!(
        of(onnx::list_attribute("value_ints", &[4, 5, 6])),
        expected(&[3], Numbers::Whole(vec![4, 5, 6]))
    );
    // Of a name that says one number.
    assert_eq!(
        of(onnx::list_attribute("value_int", &[4, 5])),
        expected(&[2], Numbers::Whole(vec![4, 5]))
    );
}

#[test]
fn what_is_not_read_is_refused_by_name() {
    let own = [
        bytes(1, b"x"),
        bytes(2, b"y"),
        bytes(4, b"FusedConv"),
        bytes(7, b"com.microsoft"),
    ]
    .concat();
    let own = model(&[bytes(1, &own), step("Swish", &["x"], &["y"], &[])]);
    let turns = onnx::loop_network(
        &Input::floats("x", &[1]),
        &onnx::Output::floats("y", &[1], vec![1.0]),
        2,
    );
    let graphs = [bytes(1, b"branches"), bytes(11, b""), int(20, 10)].concat();
    let outside = bytes(13, &[bytes(1, b"location"), bytes(2, b"weights.bin")].concat());
    let zeros = |count: usize| bytes(9, &vec![0; count]);
    let cases = [
        (own, "com.microsoft.FusedConv"),
        (turns, "Loop"),
        (model(&[step("If", &["x"], &["y"], &[graphs])]), "hold graphs: If"),
        (
            std::fs::read(home().join("tests/data/exported/torchvision_ssd.onnx")).unwrap(),
            "hold graphs: If",
        ),
        (
            std::fs::read(home().join("tests/data/exported/detr.onnx")).unwrap(),
            "lies in another file",
        ),
        (model(&[initializer(&[1], 1, &outside)]), "\"c\" lies in another file"),
        (model(&[initializer(&[1], 8, &bytes(6, b"a"))]), "\"c\" holds texts"),
        (
            model(&[initializer(&[1], 14, &zeros(8))]),
            "\"c\" holds complex numbers",
        ),
        (
            model(&[initializer(&[1], 17, &zeros(1))]),
            "\"c\" holds floats of 8 bits",
        ),
        (
            model(&[initializer(&[2], 22, &zeros(1))]),
            "\"c\" holds whole numbers of 4 bits",
        ),
        (
            model(&[initializer(&[1], 99, &zeros(1))]),
            "\"c\" holds elements of the unknown type 99",
        ),
        (
            model(&[initializer(&[3], 1, &zeros(8))]),
            "\"c\" has not as many numbers",
        ),
        (
            model(&[initializer(&[1 << 62], 1, &zeros(8))]),
            "\"c\" has not as many numbers",
        ),
        (
            model(&[initializer(&[1 << 40, 1 << 40], 1, &zeros(8))]),
            "\"c\" has not as many numbers",
        ),
        (
            model(&[initializer(&[u64::MAX], 1, &zeros(8))]),
            "\"c\" has not as many numbers",
        ),
        (model(&[initializer(&[2], 1, &zeros(7))]), "ends within a number"),
        (model(&[bytes(15, b"")]), "sparse"),
        (
            model(&[step(
                "Constant",
                &[],
                &["k"],
                &[onnx::text_attribute("value_string", "a")],
            )]),
            "holds no numbers",
        ),
        (
            model(&[step(
                "Relu",
                &["x"],
                &["y"],
                &[[bytes(1, b"odd"), int(20, 13)].concat()],
            )]),
            "\"odd\"",
        ),
        (Vec::new(), "no graph"),
        (b"GIF89a".to_vec(), "no whole ONNX file"),
        // A tensor of more bytes than any file has.
        ([varint(7 << 3 | 2), varint(u64::MAX)].concat(), "no whole ONNX file"),
    ];
    for (network, part) in cases {
        let refusal = refusal(&network);
        assert!(refusal.contains(part), "{refusal} instead of {part}");
    }
}

/// A file that is cut is no file; only at the end of a field of the file itself may it end.
#[test]
fn a_file_that_is_cut_is_refused() {
    let network = onnx::network(&[Input::floats("x", &[1])], &[onnx::Output::whole("y", &[2], &[1, 2])]);
    let (mut read, first_field) = (0, int(1, 7).len());
    for end in first_field + 1..network.len() {
        read += usize::from(Model::read(&network[..end]).is_ok());
    }
    // Without its last field, which says the opset.
    assert_eq!(read, 1);
}
