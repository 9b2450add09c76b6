//! Just enough of ONNX's protobuf (onnx.proto3) to write small networks: with constant answers whatever the image, or node by node.

/// ONNX's numbers for element types.
const FLOAT: u64 = 1;
const UINT8: u64 = 2;
const INT64: u64 = 7;
const BOOL: u64 = 9;

pub struct Input {
    name: String,
    element: u64,
    /// −1 for a side that is known at run time only.
    shape: Vec<i64>,
}

impl Input {
    fn new(name: &str, element: u64, shape: &[i64]) -> Input {
        let (name, shape) = (name.to_owned(), shape.to_vec());
        Input { name, element, shape }
    }

    pub fn floats(name: &str, shape: &[i64]) -> Input {
        Input::new(name, FLOAT, shape)
    }

    pub fn bytes(name: &str, shape: &[i64]) -> Input {
        Input::new(name, UINT8, shape)
    }

    pub fn whole(name: &str, shape: &[i64]) -> Input {
        Input::new(name, INT64, shape)
    }

    pub fn truth(name: &str, shape: &[i64]) -> Input {
        Input::new(name, BOOL, shape)
    }
}

pub struct Output {
    name: String,
    element: u64,
    shape: Vec<usize>,
    raw: Vec<u8>,
}

impl Output {
    pub fn floats(name: &str, shape: &[usize], data: Vec<f32>) -> Output {
        assert_eq!(data.len(), shape.iter().product::<usize>(), "{name}");
        let raw = data.iter().flat_map(|v| v.to_le_bytes()).collect();
        let (name, shape) = (name.to_owned(), shape.to_vec());
        Output {
            name,
            element: FLOAT,
            shape,
            raw,
        }
    }

    pub fn whole(name: &str, shape: &[usize], data: &[i64]) -> Output {
        assert_eq!(data.len(), shape.iter().product::<usize>(), "{name}");
        let raw = data.iter().flat_map(|v| v.to_le_bytes()).collect();
        let (name, shape) = (name.to_owned(), shape.to_vec());
        Output {
            name,
            element: INT64,
            shape,
            raw,
        }
    }
}

/// A ModelProto: every output = Identity(constant).
pub fn network(inputs: &[Input], outputs: &[Output]) -> Vec<u8> {
    network_with(inputs, outputs, &|constant, output| {
        node("Identity", &[constant], output, &[])
    })
}

/// A network like [`network`] whose numbers are all NaN for images whose mean is below `darkest`: output = constant + 0 · √(mean − darkest).
pub fn network_blind_in_the_dark(input: &Input, outputs: &[Output], darkest: f32) -> Vec<u8> {
    let scalar = |name: &str, value: f32| {
        let tensor = [int(2, FLOAT), bytes(8, name.as_bytes()), bytes(9, &value.to_le_bytes())].concat();
        bytes(5, &tensor)
    };
    let no_axes_kept = [bytes(1, b"keepdims"), int(3, 0), int(20, 2)].concat();
    let mean = node("ReduceMean", &[&input.name], "mean", &[&no_axes_kept]);
    let steps = [
        scalar("darkest", darkest),
        scalar("zero", 0.0),
        mean,
        node("Sub", &["mean", "darkest"], "above", &[]),
        node("Sqrt", &["above"], "root", &[]),
        node("Mul", &["root", "zero"], "nothing", &[]),
    ];
    network_with(std::slice::from_ref(input), outputs, &|constant, output| {
        [steps.concat(), node("Add", &[constant, "nothing"], output, &[])].concat()
    })
}

/// A network written node by node, for one image. Any output may be named; its shape is left open.
pub fn graph(input: &Input, parts: &[Vec<u8>], outputs: &[&str], opset: u64) -> Vec<u8> {
    let mut graph = bytes(2, b"graph");
    graph.extend(parts.concat());
    graph.extend(bytes(11, &value(&input.name, input.element, &input.shape)));
    for output in outputs {
        let floats = bytes(1, &int(1, FLOAT));
        graph.extend(bytes(12, &[bytes(1, output.as_bytes()), bytes(2, &floats)].concat()));
    }
    [int(1, 8), bytes(7, &graph), bytes(8, &int(2, opset))].concat()
}

/// A network that turns its answer's sign in a loop: after an even number of turns it is `answer`.
pub fn loop_network(input: &Input, answer: &Output, turns: i64) -> Vec<u8> {
    let name = answer.name.as_str();
    let shape: Vec<i64> = answer.shape.iter().map(|side| *side as i64).collect();
    let [before, after] = ["before", "after"].map(|name| Input::new(name, answer.element, &shape));
    let steps = [
        step("Identity", &["go_on"], &["goes_on"], &[]),
        step("Neg", &["before"], &["after"], &[]),
    ];
    let inputs = [Input::whole("turn", &[]), Input::truth("go_on", &[]), before];
    let one_turn = graph_attribute("body", &body(&inputs, &steps, &[Input::truth("goes_on", &[]), after]));
    let parts = [
        whole_constant("turns", &[], &[turns]),
        initializer("start", answer.element, &answer.shape, &answer.raw),
        step("Loop", &["turns", "", "start"], &[name], &[one_turn]),
    ];
    graph(input, &parts, &[name], 13)
}

/// The graph inside a `Loop` or an `If`, for [`graph_attribute`].
pub fn body(inputs: &[Input], parts: &[Vec<u8>], outputs: &[Input]) -> Vec<u8> {
    let listed = |field: u64, ports: &[Input]| -> Vec<u8> {
        let one = |port: &Input| bytes(field, &value(&port.name, port.element, &port.shape));
        ports.iter().flat_map(one).collect()
    };
    [
        bytes(2, b"body"),
        parts.concat(),
        listed(11, inputs),
        listed(12, outputs),
    ]
    .concat()
}

/// Weights of a network.
pub fn constant(name: &str, shape: &[usize], data: &[f32]) -> Vec<u8> {
    assert_eq!(data.len(), shape.iter().product::<usize>(), "{name}");
    let raw: Vec<u8> = data.iter().flat_map(|v| v.to_le_bytes()).collect();
    initializer(name, FLOAT, shape, &raw)
}

/// Shapes, axes and the like.
pub fn whole_constant(name: &str, shape: &[usize], data: &[i64]) -> Vec<u8> {
    assert_eq!(data.len(), shape.iter().product::<usize>(), "{name}");
    let raw: Vec<u8> = data.iter().flat_map(|v| v.to_le_bytes()).collect();
    initializer(name, INT64, shape, &raw)
}

fn initializer(name: &str, element: u64, shape: &[usize], raw: &[u8]) -> Vec<u8> {
    let dims: Vec<u8> = shape.iter().flat_map(|d| int(1, *d as u64)).collect();
    bytes(
        5,
        &[dims, int(2, element), bytes(8, name.as_bytes()), bytes(9, raw)].concat(),
    )
}

/// A node with several outputs.
pub fn step(operator: &str, inputs: &[&str], outputs: &[&str], attributes: &[Vec<u8>]) -> Vec<u8> {
    let mut node: Vec<u8> = inputs.iter().flat_map(|i| bytes(1, i.as_bytes())).collect();
    node.extend(outputs.iter().flat_map(|o| bytes(2, o.as_bytes())));
    node.extend(bytes(3, format!("{operator}_{}", outputs[0]).as_bytes()));
    node.extend(bytes(4, operator.as_bytes()));
    node.extend(attributes.iter().flat_map(|a| bytes(5, a)));
    bytes(1, &node)
}

pub fn whole_attribute(name: &str, v: i64) -> Vec<u8> {
    [bytes(1, name.as_bytes()), int(3, v as u64), int(20, 2)].concat()
}

pub fn graph_attribute(name: &str, graph: &[u8]) -> Vec<u8> {
    [bytes(1, name.as_bytes()), bytes(6, graph), int(20, 5)].concat()
}

pub fn list_attribute(name: &str, v: &[i64]) -> Vec<u8> {
    let values: Vec<u8> = v.iter().flat_map(|v| int(8, *v as u64)).collect();
    [bytes(1, name.as_bytes()), values, int(20, 7)].concat()
}

pub fn float_attribute(name: &str, v: f32) -> Vec<u8> {
    [
        bytes(1, name.as_bytes()),
        varint(2 << 3 | 5),
        v.to_le_bytes().to_vec(),
        int(20, 1),
    ]
    .concat()
}

pub fn text_attribute(name: &str, v: &str) -> Vec<u8> {
    [bytes(1, name.as_bytes()), bytes(4, v.as_bytes()), int(20, 3)].concat()
}

/// A node of the graph, with attributes as their own messages.
fn node(operator: &str, inputs: &[&str], output: &str, attributes: &[&[u8]]) -> Vec<u8> {
    let mut node: Vec<u8> = inputs.iter().flat_map(|i| bytes(1, i.as_bytes())).collect();
    node.extend(bytes(2, output.as_bytes()));
    node.extend(bytes(4, operator.as_bytes()));
    node.extend(attributes.iter().flat_map(|a| bytes(5, a)));
    bytes(1, &node)
}

/// `nodes` gives what of the graph leads from a constant to an output, by their names.
fn network_with(inputs: &[Input], outputs: &[Output], nodes: &dyn Fn(&str, &str) -> Vec<u8>) -> Vec<u8> {
    let mut graph = bytes(2, b"graph");
    for (i, output) in outputs.iter().enumerate() {
        let constant = format!("constant_{i}");
        let dims: Vec<u8> = output.shape.iter().flat_map(|d| int(1, *d as u64)).collect();
        let tensor = [
            dims,
            int(2, output.element),
            bytes(8, constant.as_bytes()),
            bytes(9, &output.raw),
        ]
        .concat();
        let shape: Vec<i64> = output.shape.iter().map(|d| *d as i64).collect();
        graph.extend([nodes(&constant, &output.name), bytes(5, &tensor)].concat());
        graph.extend(bytes(12, &value(&output.name, output.element, &shape)));
    }
    for input in inputs {
        graph.extend(bytes(11, &value(&input.name, input.element, &input.shape)));
    }
    let opset = bytes(8, &int(2, 13));
    [int(1, 7), bytes(7, &graph), opset].concat()
}

/// An entry of the model's metadata, to be appended to a network.
pub fn metadata(key: &str, text: &str) -> Vec<u8> {
    bytes(14, &[bytes(1, key.as_bytes()), bytes(2, text.as_bytes())].concat())
}

/// ValueInfoProto of a tensor.
fn value(name: &str, element: u64, shape: &[i64]) -> Vec<u8> {
    let dimension = |(i, d): (usize, &i64)| match u64::try_from(*d) {
        Ok(d) => int(1, d),
        Err(_) => bytes(2, format!("side_{i}").as_bytes()),
    };
    let dims: Vec<u8> = shape.iter().enumerate().flat_map(|d| bytes(1, &dimension(d))).collect();
    let tensor = [int(1, element), bytes(2, &dims)].concat();
    [bytes(1, name.as_bytes()), bytes(2, &bytes(1, &tensor))].concat()
}

pub fn varint(mut v: u64) -> Vec<u8> {
    let mut out = Vec::new();
    while v >= 0x80 {
        out.push(v as u8 | 0x80);
        v >>= 7;
    }
    out.push(v as u8);
    out
}

pub fn int(field: u64, v: u64) -> Vec<u8> {
    [varint(field << 3), varint(v)].concat()
}

pub fn bytes(field: u64, v: &[u8]) -> Vec<u8> {
    [varint(field << 3 | 2), varint(v.len() as u64), v.to_vec()].concat()
}
