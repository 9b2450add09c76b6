use scaleproof_score::report::latex::markup::escaped;

#[test]
fn what_tex_takes_for_commands_is_escaped() {
    assert_eq!(escaped("a_b & 50 % {x} #1 $"), "a\\_b \\& 50 \\% \\{x\\} \\#1 \\$");
    assert_eq!(
        escaped("\\end^~"),
        "\\textbackslash{}end\\textasciicircum{}\\textasciitilde{}"
    );
    assert_eq!(escaped("[1]*\n"), "{[}1]{*} ");
    assert_eq!(escaped("Größe"), "Größe");
}
