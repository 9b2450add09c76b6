//! As much of Markdown as the documentation uses: headings and their anchors, links, fenced blocks, code spans.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A page of documentation.
pub struct Page {
    pub path: PathBuf,
    /// From the project's folder, with slashes: for messages.
    pub name: String,
    /// The lines outside fenced blocks, with their numbers from 1.
    pub prose: Vec<(usize, String)>,
    pub blocks: Vec<Block>,
}

/// A fenced block.
pub struct Block {
    /// Number of its first line inside the fence.
    pub line: usize,
    /// What stands behind the opening fence.
    pub info: String,
    pub text: String,
    /// The HTML comment on the last line before it that is not empty, without its marks.
    pub remark: Option<String>,
}

/// A link or an image.
pub struct Link {
    pub line: usize,
    pub target: String,
}

impl Page {
    pub fn open(home: &Path, path: &Path) -> Page {
        let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let (mut prose, mut blocks): (Vec<(usize, String)>, Vec<Block>) = (Vec::new(), Vec::new());
        let mut open: Option<(String, Block)> = None;
        for (i, line) in text.lines().enumerate() {
            let bare = line.trim_start();
            let ticks: String = bare.chars().take_while(|c| *c == '`').collect();
            match &mut open {
                Some((fence, block)) if ticks.len() >= fence.len() && bare.trim_end() == ticks => {
                    let _ = &block;
                    blocks.extend(open.take().map(|(_, block)| block));
                }
                Some((_, block)) => {
                    block.text.push_str(line);
                    block.text.push('\n');
                }
                None if ticks.len() >= 3 => {
                    let before = prose.iter().rev().map(|(_, line)| line.trim()).find(|l| !l.is_empty());
                    let remark = before.and_then(|l| l.strip_prefix("<!--")?.strip_suffix("-->"));
                    open = Some((
                        ticks.clone(),
                        Block {
                            line: i + 2,
                            info: bare[ticks.len()..].trim().to_owned(),
                            text: String::new(),
                            remark: remark.map(|r| r.trim().to_owned()),
                        },
                    ));
                    // A remark belongs to one block.
                    prose.push((i + 1, ".".into()));
                }
                None => prose.push((i + 1, line.to_owned())),
            }
        }
        let name = path
            .strip_prefix(home)
            .unwrap_or(path)
            .to_string_lossy()
            .replace('\\', "/");
        assert!(open.is_none(), "{name}: a fenced block has no end");
        Page {
            path: path.to_owned(),
            name,
            prose,
            blocks,
        }
    }

    /// Headings with their level and number of line.
    pub fn headings(&self) -> impl Iterator<Item = (usize, usize, &str)> {
        self.prose.iter().filter_map(|(line, text)| {
            let level = text.chars().take_while(|c| *c == '#').count();
            let title = text[level..].strip_prefix(' ')?;
            (1..=6).contains(&level).then_some((*line, level, title.trim()))
        })
    }

    /// What may stand behind a `#` in a link to this page, by GitHub's rules.
    pub fn anchors(&self) -> Vec<String> {
        let mut times: BTreeMap<String, usize> = BTreeMap::new();
        let mut anchors = Vec::new();
        for (_, _, title) in self.headings() {
            let slug = slug(title);
            let count = times.entry(slug.clone()).or_default();
            anchors.push(match *count {
                0 => slug,
                n => format!("{slug}-{n}"),
            });
            *count += 1;
        }
        for (_, line) in &self.prose {
            for mark in ["<a id=\"", "<a name=\""] {
                anchors.extend(
                    line.split(mark)
                        .skip(1)
                        .filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())),
                );
            }
        }
        anchors
    }

    /// Links and images outside code.
    pub fn links(&self) -> Vec<Link> {
        let mut links = Vec::new();
        for (line, text) in &self.prose {
            let text = without_code(text);
            let inline = text
                .split("](")
                .skip(1)
                .filter_map(|rest| rest.split_once(')').map(|(inside, _)| inside));
            let defined = text
                .trim_start()
                .strip_prefix('[')
                .and_then(|rest| Some(rest.split_once("]: ")?.1));
            let html = ["src=\"", "href=\""]
                .into_iter()
                .flat_map(|mark| text.split(mark).skip(1));
            let html = html.filter_map(|rest| rest.split_once('"').map(|(inside, _)| inside));
            let bare = text.split('<').skip(1).filter(|rest| rest.starts_with("http"));
            let bare = bare.filter_map(|rest| rest.split_once('>').map(|(inside, _)| inside));
            for target in inline.chain(defined).chain(html).chain(bare) {
                // Behind a blank stands a title.
                let target = target.trim().split(" \"").next().unwrap_or_default();
                links.push(Link {
                    line: *line,
                    target: target.trim_matches(['<', '>']).to_owned(),
                });
            }
        }
        links
    }

    /// Code spans outside fenced blocks.
    pub fn code_spans(&self) -> Vec<(usize, String)> {
        let spans = |(line, text): &(usize, String)| {
            let inside = text.split('`').enumerate().filter(|(i, _)| i % 2 == 1);
            inside.map(|(_, span)| (*line, span.to_owned())).collect::<Vec<_>>()
        };
        self.prose.iter().flat_map(spans).collect()
    }
}

/// A title as GitHub makes an anchor of it: lower case, blanks as dashes, no other marks than `-` and `_`.
fn slug(title: &str) -> String {
    let text = linked_text(title).to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The text of a title without the targets of its links.
fn linked_text(title: &str) -> String {
    let mut text = String::new();
    for (i, part) in title.split("](").enumerate() {
        text.push_str(if i == 0 {
            part
        } else {
            part.split_once(')').map_or(part, |(_, rest)| rest)
        });
    }
    text.replace('[', "")
}

fn without_code(line: &str) -> String {
    let outside = line.split('`').enumerate().filter(|(i, _)| i % 2 == 0);
    outside.map(|(_, text)| text).collect::<Vec<_>>().join("`")
}

/// Every page of documentation in the project.
pub fn all(home: &Path) -> Vec<Page> {
    let mut pages = Vec::new();
    walk(home, home, &mut pages);
    pages.sort_by(|a, b| a.name.cmp(&b.name));
    pages
}

fn walk(home: &Path, folder: &Path, pages: &mut Vec<Page>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // What is built or fetched, and notes that somebody keeps beside the project's own pages.
        if name.starts_with('.') || ["target", "out"].contains(&name.as_str()) || name.starts_with("NOTES-") {
            continue;
        }
        if path.is_dir() {
            walk(home, &path, pages);
        } else if name.ends_with(".md") {
            pages.push(Page::open(home, &path));
        }
    }
}

#[test]
fn anchors_are_those_of_github() {
    for (title, anchor) in [
        ("scene.toml", "scenetoml"),
        ("Score: `scaleproof score`", "score-scaleproof-score"),
        ("What an image may cost", "what-an-image-may-cost"),
        ("See [the guide](guide.md) & more", "see-the-guide--more"),
        ("`locate --json`", "locate---json"),
    ] {
        assert_eq!(slug(title), anchor);
    }
}
