use super::*;
use crate::tokens::secret;

fn open() -> Class {
    let mut class = Class::default();
    class.open(true);
    class
}

/// Joins with a fresh key, where no lesson runs.
fn join(
    class: &mut Class,
    page: Page,
    name: &str,
    key: Option<&str>,
) -> Result<(String, String), JoinError> {
    class.join(page, name, key, &[], secret().unwrap())
}

fn names(class: &Class) -> Vec<&str> {
    class.seats().iter().map(|s| s.name.as_str()).collect()
}

#[test]
fn a_pseudonym_belongs_to_one_phone() {
    let mut class = open();
    let (name, key) = join(&mut class, 1, "  Zoë 2 ", None).unwrap();
    assert_eq!(name, "Zoë 2");
    for (page, other, given) in [
        (2, "Zoë 2", None),
        (3, "zoË 2", Some("")),
        (4, "Zoë 2", Some("x")),
    ] {
        let error = join(&mut class, page, other, given).unwrap_err();
        assert_eq!(error, JoinError::Taken(other.to_owned()));
        assert_eq!(class.name_of(page), None);
    }
    let guess = secret().unwrap();
    assert!(join(&mut class, 5, "Zoë 2", Some(&guess)).is_err());
    // After a reload the page has another number, and the phone the same key.
    assert!(class.left(1) && !class.left(1));
    assert_eq!(
        join(&mut class, 6, "zoë 2", Some(&key)),
        Ok(("Zoë 2".to_owned(), key))
    );
    assert_eq!(class.name_of(6), Some("Zoë 2"));
    assert_eq!(names(&class), ["Zoë 2"]);
}

/// One that can be guessed, such as an empty one, would give the seat to the next phone that sends it.
#[test]
fn a_key_that_is_none_is_replaced() {
    for given in ["", "x", "0123456789ABCDEF0123456789ABCDEF"] {
        let mut class = open();
        let (_, key) = join(&mut class, 1, "Ada", Some(given)).unwrap();
        assert!(is_secret(&key), "{key}");
        assert!(join(&mut class, 2, "Ada", Some(given)).is_err());
        // Also where the seat waits for a phone.
        class.free("Ada", true);
        let (_, key) = join(&mut class, 3, "Ada", Some(given)).unwrap();
        assert!(is_secret(&key), "{key}");
    }
}

#[test]
fn names_that_are_no_pseudonyms_are_rejected() {
    let mut class = open();
    for name in ["", " ", "<b>", "a\u{202e}b", "-a", &"x".repeat(21)] {
        let error = join(&mut class, 1, name, None).unwrap_err();
        assert!(matches!(error, JoinError::Pseudonym(_)), "{name}: {error}");
    }
}

#[test]
fn a_phone_has_one_seat() {
    let mut class = open();
    join(&mut class, 1, "Ada", None).unwrap();
    let joined = JoinError::Joined("Ada".to_owned());
    assert_eq!(join(&mut class, 1, "Ben", None), Err(joined));
    assert!(class.is_here(&class.seats()[0]));
    class.left(1);
    assert!(!class.is_here(&class.seats()[0]));
}

#[test]
fn without_the_teacher_nobody_new_comes_in() {
    let mut class = open();
    let (_, key) = join(&mut class, 1, "Ada", None).unwrap();
    class.open(false);
    assert_eq!(join(&mut class, 2, "Ben", None), Err(JoinError::Closed));
    assert!(join(&mut class, 3, "Ada", Some(&key)).is_ok());
    class.open(true);
    // Those whom the teacher has entered answer on the teacher's page.
    let students = ["Cem".to_owned()];
    let error = class.join(4, "cem", None, &students, secret().unwrap());
    assert_eq!(error, Err(JoinError::Taken("cem".to_owned())));
    for nth in 1..MOST_STUDENTS {
        let page = 10 + u64::try_from(nth).unwrap();
        join(&mut class, page, &format!("s{nth}"), None).unwrap();
    }
    assert_eq!(join(&mut class, 99, "late", None), Err(JoinError::Full));
}

#[test]
fn a_freed_seat_waits_for_one_phone() {
    let mut class = open();
    let (_, lost) = join(&mut class, 1, "Ada", None).unwrap();
    class.free("Ada", true);
    assert_eq!(class.pages().collect::<Vec<_>>(), [(1, None)]);
    assert!(class.seats()[0].is_free());
    class.open(false);
    let (_, key) = join(&mut class, 2, "Ada", None).unwrap();
    assert_ne!(key, lost);
    let error = join(&mut class, 3, "Ada", Some(&lost));
    assert!(matches!(error, Err(JoinError::Taken(_))));
    // Without a lesson there is nothing to keep.
    class.free("Ada", false);
    assert!(class.seats().is_empty());
}

#[test]
fn an_interrupted_lesson_gives_seats_back_to_their_phones() {
    let mut before = open();
    let (_, ada) = join(&mut before, 1, "Ada", None).unwrap();
    let (_, ben) = join(&mut before, 2, "Ben", None).unwrap();
    let mut class = open();
    // Ada's phone still has its key, and somebody is quicker than Ben.
    join(&mut class, 1, "Ada", Some(&ada)).unwrap();
    join(&mut class, 2, "Ben", None).unwrap();
    class.restore(&before.keys());
    assert_eq!((class.name_of(1), class.name_of(2)), (Some("Ada"), None));
    assert!(join(&mut class, 3, "Ben", None).is_err());
    assert!(join(&mut class, 3, "Ben", Some(&ben)).is_ok());
    assert_eq!(class.keys(), before.keys());
}
