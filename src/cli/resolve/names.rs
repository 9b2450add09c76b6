//! Names of textures and places that a session may have.

/// Refuses, before anything is made, names that a session cannot have.
pub fn check_names(variant: &str, place: &str) -> Result<(), String> {
    for (what, name) in [("--variant", variant), ("--place", place)] {
        if name.trim().is_empty() || name.trim() != name || name.chars().any(char::is_control) {
            return Err(format!(
                "{what} is {name:?}: give a name without blanks around it or control characters"
            ));
        }
    }
    Ok(())
}
