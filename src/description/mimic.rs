//! Chains of mimic joints, resolved to the joint at their end.
//!
//! ```text
//!     q = m q' + o  and  q' = m' q" + o'   give   q = m m' q" + (m o' + o)
//! ```

use super::{Description, Mimic};
use crate::error::{Reason, Result};

impl Description {
    /// Returns for each mimic joint the joint at the end of its chain, which is not a mimic joint, with multiplier and
    /// offset of the whole chain; `None` for other joints. Takes linear time.
    ///
    /// # Errors
    /// Returns [`Reason::Inconsistent`] if joints mimic each other in a cycle.
    pub fn mimicked(&self) -> Result<Vec<Option<Mimic>>> {
        let joints = &self.joints;
        let mut ends: Vec<Option<Mimic>> = vec![None; joints.len()];
        let mut on_the_way = vec![false; joints.len()];
        for start in 0..joints.len() {
            // Walks to a joint that is already resolved, and back.
            let (mut way, mut at) = (Vec::new(), start);
            while let (Some(mimic), None) = (&joints[at].mimic, &ends[at]) {
                if on_the_way[at] {
                    let reason = Reason::Inconsistent("it follows itself: the <mimic> elements form a circle".into());
                    return Err(joints[at].refuse(reason).hint("let one of these joints follow none"));
                }
                on_the_way[at] = true;
                way.push((at, mimic));
                at = mimic.joint;
            }
            for (joint, mimic) in way.into_iter().rev() {
                on_the_way[joint] = false;
                ends[joint] = Some(match &ends[mimic.joint] {
                    Some(end) => Mimic {
                        joint: end.joint,
                        multiplier: mimic.multiplier * end.multiplier,
                        offset: mimic.multiplier * end.offset + mimic.offset,
                    },
                    None => mimic.clone(),
                });
            }
        }
        Ok(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_refused() {
        // For each of four joints, the joint that it mimics.
        for mimicked in [[Some(0), None, None, None], [None, Some(2), Some(1), None], [Some(1), Some(2), Some(1), None]]
        {
            let joint = |(k, mimicked): (usize, Option<usize>)| {
                let mimic = mimicked.map_or(String::new(), |other| format!("<mimic joint='j{other}'/>"));
                let ends = format!("<parent link='{k}'/><child link='{}'/>", k + 1);
                format!("<link name='{k}'/><joint name='j{k}' type='continuous'>{ends}{mimic}</joint>")
            };
            let body: String = mimicked.into_iter().enumerate().map(joint).collect();
            let text = format!("<robot>{body}<link name='4'/></robot>");
            let refused = Description::from_urdf(&text).expect("a description").mimicked().expect_err("a circle");
            assert!(refused.to_string().contains("follows itself"), "{refused}");
        }
    }
}
