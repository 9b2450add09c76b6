use scaleproof_core::message::Message;
use scaleproof_score::shard::{Run, Shard, ShardError, ShardId, ShardObservations, whole_run};

fn parsed(text: &str, environment: &[(&str, &str)]) -> Result<ShardId, Message> {
    let find = |name: &str| {
        environment
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, v)| (*v).to_owned())
    };
    ShardId::parse(text, find)
}

#[test]
fn a_shard_is_named_by_the_user_or_by_the_job() {
    let id = |index, count| ShardId { index, count };
    assert_eq!(parsed("2/3", &[]).unwrap(), id(2, 3));
    let slurm = [
        ("SLURM_ARRAY_TASK_ID", "7"),
        ("SLURM_ARRAY_TASK_MIN", "5"),
        ("SLURM_ARRAY_TASK_MAX", "8"),
        ("SLURM_ARRAY_TASK_COUNT", "4"),
    ];
    assert_eq!(parsed("slurm", &slurm).unwrap(), id(3, 4));
    assert_eq!(parsed("k8s/4", &[("JOB_COMPLETION_INDEX", "0")]).unwrap(), id(1, 4));
    for text in ["0/3", "4/3", "3", "a/b", "-1/2", "1/0", "", "k8s", "k8s/0"] {
        assert!(parsed(text, &[("JOB_COMPLETION_INDEX", "0")]).is_err(), "{text}");
    }
    assert!(parsed("k8s/4", &[("JOB_COMPLETION_INDEX", "4")]).is_err());
    assert_eq!(
        parsed("slurm", &[]).unwrap_err().to_string(),
        "SLURM_ARRAY_TASK_MIN is not set: this is no such job, write the shard as 2/3"
    );
    let mut gaps = slurm;
    gaps[2].1 = "11";
    assert!(parsed("slurm", &gaps).unwrap_err().to_string().contains("without gaps"));
}

#[test]
fn a_mistyped_count_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let written = |index, count| {
        let (run, observed) = (Run::default(), ShardObservations::new());
        let id = ShardId { index, count };
        let shard = Shard { run, id, observed };
        shard.write(folder.path()).unwrap()
    };
    let refused = whole_run(&[written(2, u64::MAX)]).unwrap_err().to_string();
    assert!(refused.contains("missing: 1, 3, 4, 5, 6, and others"), "{refused}");
    assert!(matches!(whole_run(&[written(4, 3)]), Err(ShardError::Damaged { .. })));
}

#[test]
fn every_photo_is_in_one_shard() {
    for count in 1..8 {
        for photo in 1..100 {
            let shards = (1..=count).map(|index| ShardId { index, count });
            assert_eq!(shards.filter(|shard| shard.holds(photo)).count(), 1);
        }
    }
}
