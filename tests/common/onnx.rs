//! Just enough of ONNX's protobuf (onnx.proto3) to write a network that answers with constants, whatever the picture.
#![allow(dead_code)] // each test file uses its part

/// ONNX's numbers for element types.
const FLOAT: u64 = 1;
const UINT8: u64 = 2;
const INT64: u64 = 7;

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
        let node = [
            bytes(1, constant.as_bytes()),
            bytes(2, output.name.as_bytes()),
            bytes(4, b"Identity"),
        ]
        .concat();
        let shape: Vec<i64> = output.shape.iter().map(|d| *d as i64).collect();
        graph.extend([bytes(1, &node), bytes(5, &tensor)].concat());
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

fn varint(mut v: u64) -> Vec<u8> {
    let mut out = Vec::new();
    while v >= 0x80 {
        out.push(v as u8 | 0x80);
        v >>= 7;
    }
    out.push(v as u8);
    out
}

fn int(field: u64, v: u64) -> Vec<u8> {
    [varint(field << 3), varint(v)].concat()
}

fn bytes(field: u64, v: &[u8]) -> Vec<u8> {
    [varint(field << 3 | 2), varint(v.len() as u64), v.to_vec()].concat()
}
