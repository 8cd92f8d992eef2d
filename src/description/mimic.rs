//! Chains of mimic joints, resolved to the joint at their end.
//!
//! ```text
//!     q = m q' + o  and  q' = m' q" + o'   give   q = m m' q" + (m o' + o)
//! ```

use super::{Joint, Mimic};
use crate::error::{Reason, Result};

/// See [`super::Description::leaders`]. Linear in the number of joints.
pub(super) fn leaders(joints: &[Joint]) -> Result<Vec<Option<Mimic>>> {
    let mut leaders: Vec<Option<Mimic>> = vec![None; joints.len()];
    let mut on_the_way = vec![false; joints.len()];
    for start in 0..joints.len() {
        // To a joint that is resolved already, and back.
        let (mut way, mut at) = (Vec::new(), start);
        while let (Some(mimic), None) = (&joints[at].mimic, &leaders[at]) {
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
            leaders[joint] = Some(match &leaders[mimic.joint] {
                Some(leader) => Mimic {
                    joint: leader.joint,
                    multiplier: mimic.multiplier * leader.multiplier,
                    offset: mimic.multiplier * leader.offset + mimic.offset,
                },
                None => mimic.clone(),
            });
        }
    }
    Ok(leaders)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Description;

    fn read(mimics: &[(usize, &str)]) -> Result<Vec<Option<Mimic>>> {
        let joint = |k: usize| {
            let mimic = mimics.iter().find(|(follower, _)| *follower == k).map_or("", |(_, mimic)| mimic);
            format!(
                "<link name='{}'/><joint name='j{k}' type='continuous'><parent link='{k}'/><child link='{}'/>{mimic}</joint>",
                k + 1,
                k + 1
            )
        };
        let body: String = (0..4).map(joint).collect();
        let text = format!("<robot><link name='0'/>{body}</robot>");
        Description::from_urdf(&text).expect("a description").leaders()
    }

    #[test]
    fn a_chain_leads_to_its_last_joint_whatever_the_order() {
        let chain = [
            (0, "<mimic joint='j1' multiplier='2' offset='1'/>"),
            (1, "<mimic joint='j3' multiplier='-3' offset='5'/>"),
        ];
        // q0 = 2 q1 + 1, q1 = -3 q3 + 5.
        let leaders = read(&chain).expect("no circle");
        assert_eq!(leaders[0], Some(Mimic { joint: 3, multiplier: -6.0, offset: 11.0 }));
        assert_eq!(leaders[1], Some(Mimic { joint: 3, multiplier: -3.0, offset: 5.0 }));
        assert_eq!(leaders[2..], [None, None]);
    }

    #[test]
    fn circles_are_refused() {
        for circle in [
            &[(0, "<mimic joint='j0'/>")][..],
            &[(1, "<mimic joint='j2'/>"), (2, "<mimic joint='j1'/>")],
            &[(0, "<mimic joint='j1'/>"), (1, "<mimic joint='j2'/>"), (2, "<mimic joint='j1'/>")],
        ] {
            let refused = read(circle).expect_err("a circle");
            assert!(refused.to_string().contains("follows itself"), "{refused}");
        }
    }
}
