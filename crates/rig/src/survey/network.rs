//! Network of tags and the photos that show them, which is adjusted, and the parts it falls into.

use std::collections::BTreeMap;

use super::residual::squared_px;
use scaleproof_core::geometry::{Rigid, UnionFind};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::TagFamily;

/// Key of a tag: ids are only unique within a family.
pub(super) type TagKey = (TagFamily, u32);

/// The corners of a tag too small to bend, for [`scaleproof_pose::locate::expected_px2`].
pub(super) const TINY: [[f64; 2]; 4] = [[0.0; 2]; 4];

/// A tag of known size.
#[derive(Debug, Clone)]
pub(super) struct SizedTag {
    pub key: TagKey,
    pub size_mm: f64,
    /// `T_model_tag` when the pose is given and kept.
    pub fixed: Option<Rigid>,
}

#[derive(Debug, Clone)]
pub(super) struct Sighting {
    /// Index into [`TagNetwork::tags`].
    pub tag: usize,
    pub photo: usize,
    pub corners_px: [[f64; 2]; 4],
    /// The planar branches, `T_camera_tag`: at most two, the better first.
    pub branches: Vec<Rigid>,
    /// Weight of its squared residuals: the variance that is expected of a tiny tag's corner, over that of its own corners
    /// ([`scaleproof_pose::locate::expected_px2`]), which grows with the tag because paper bends.
    pub weight: f64,
}

impl Sighting {
    /// Returns true if it is of this photo or tag.
    pub(super) fn is_of(&self, node: Node) -> bool {
        match node {
            Node::Photo(photo) => self.photo == photo,
            Node::Tag(tag) => self.tag == tag,
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct TagNetwork {
    /// The survey's camera; it fits every photo.
    pub camera: Camera,
    pub tags: Vec<SizedTag>,
    pub photos: usize,
    pub sightings: Vec<Sighting>,
}

/// A photo or a tag: each has a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Node {
    Photo(usize),
    Tag(usize),
}

/// Poses as far as they are known: `T_model_tag` of the tags, `T_camera_model` of the photos.
#[derive(Debug, Clone)]
pub(super) struct Poses {
    pub tags: Vec<Option<Rigid>>,
    pub photos: Vec<Option<Rigid>>,
}

impl Poses {
    /// Returns `T_camera_tag` of a sighting, when both ends are known.
    pub(super) fn camera_tag(&self, s: &Sighting) -> Option<Rigid> {
        Some(self.photos[s.photo]? * self.tags[s.tag]?)
    }

    /// Returns the pose of a photo or a tag.
    pub(super) fn pose_mut(&mut self, node: Node) -> &mut Option<Rigid> {
        match node {
            Node::Photo(photo) => &mut self.photos[photo],
            Node::Tag(tag) => &mut self.tags[tag],
        }
    }
}

impl TagNetwork {
    /// Returns the sightings of a photo or a tag.
    pub(super) fn sightings_of(&self, node: Node) -> impl Iterator<Item = &Sighting> {
        self.sightings.iter().filter(move |s| s.is_of(node))
    }

    /// Returns true if a photo or a tag has a sighting.
    pub(super) fn is_seen(&self, node: Node) -> bool {
        self.sightings_of(node).next().is_some()
    }

    pub(super) fn is_fixed(&self, tag: usize) -> bool {
        self.tags[tag].fixed.is_some()
    }

    /// Returns the tags that are not fixed, then the photos.
    pub(super) fn free(&self) -> impl Iterator<Item = Node> {
        let tags = (0..self.tags.len()).filter(move |t| !self.is_fixed(*t));
        tags.map(Node::Tag).chain((0..self.photos).map(Node::Photo))
    }

    /// Returns the weighted squared distance in px² of each corner of a sighting from where the poses put it; `None` when a pose is unknown.
    pub(super) fn squared_px(&self, s: &Sighting, poses: &Poses) -> Option<[f64; 4]> {
        Some(self.squared_px_under(&poses.camera_tag(s)?, s))
    }

    /// Returns the weighted squared distance in px² of each corner of a sighting from where a pose `T_camera_tag` puts it.
    pub(super) fn squared_px_under(&self, camera_tag: &Rigid, s: &Sighting) -> [f64; 4] {
        let squared = squared_px(camera_tag, self.tags[s.tag].size_mm, &s.corners_px, &self.camera);
        squared.map(|e| s.weight * e)
    }

    /// Returns the network with only the sightings that `keep` accepts; all tags and photos stay.
    pub(super) fn with(&self, keep: impl Fn(&Sighting) -> bool) -> Self {
        TagNetwork {
            sightings: self.sightings.iter().filter(|s| keep(s)).cloned().collect(),
            ..self.clone()
        }
    }

    /// Returns the seen tags in groups that shared photos connect; fixed tags, whose places are known, are one to begin with. The group
    /// with the fixed tags comes first, the others by their first tag.
    pub(super) fn groups(&self) -> Vec<Vec<usize>> {
        let mut sets = UnionFind::new(self.tags.len());
        let mut join = |tags: Vec<usize>| tags.windows(2).for_each(|pair| sets.unite(pair[0], pair[1]));
        join((0..self.tags.len()).filter(|t| self.is_fixed(*t)).collect());
        for photo in 0..self.photos {
            join(self.sightings_of(Node::Photo(photo)).map(|s| s.tag).collect());
        }
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for tag in (0..self.tags.len()).filter(|t| self.is_seen(Node::Tag(*t))) {
            groups.entry(sets.root(tag)).or_default().push(tag);
        }
        let mut groups: Vec<Vec<usize>> = groups.into_values().collect();
        groups.sort_by_key(|g| !g.iter().any(|t| self.is_fixed(*t)));
        groups
    }
}
