"""Skills are read strictly: what another tool would read otherwise, or not at all, is refused."""

from pathlib import Path

import pytest

from wsim.skills import SkillError, skills, skills_folder

GOOD = "---\nname: {name}\ndescription: Write a thing. Use it when a thing is asked for.\n---\n\n# Things\n\nText.\n"


def written(folder: Path, text: str, name: str = "things") -> Path:
    (folder / name).mkdir()
    (folder / name / "SKILL.md").write_text(text, encoding="utf-8")
    return folder


def test_a_skill_is_its_front_matter_and_its_body(tmp_path: Path) -> None:
    (skill,) = skills(written(tmp_path, GOOD.format(name="things")))
    assert (skill.name, skill.folder) == ("things", tmp_path / "things")
    assert skill.description == "Write a thing. Use it when a thing is asked for."
    assert skill.text == GOOD.format(name="things") and skill.body == "# Things\n\nText.\n"
    assert skill.headings == ["Things"]


def test_headings_leave_out_comments_of_code(tmp_path: Path) -> None:
    text = GOOD.format(name="things") + "\n## More\n\n```python\n# no heading\n```\n"
    (skill,) = skills(written(tmp_path, text))
    assert skill.headings == ["Things", "More"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# Things\n", "must begin with front matter"),
        ("---\nname: things\n", "must begin with front matter"),
        (GOOD.format(name="other"), 'must be the name of its folder, "things"'),
        ("---\nname: things\n---\n", "description is missing"),
        ("---\ndescription: Text.\n---\n", "name is missing"),
        ("---\nname: things\nname: things\n---\n", "one line each"),
        ("---\nname: things\ntitle: Things\n---\n", "one line each"),
        ("---\nname: things\ndescription: Text\n  that goes on.\n---\n", "one line each"),
        ("---\nname: things\ndescription: |\n---\n", "no plain YAML scalar"),
        ("---\nname: things\ndescription: Things: many.\n---\n", "no plain YAML scalar"),
        ("---\nname: things\ndescription: Text #1.\n---\n", "no plain YAML scalar"),
        (f"---\nname: things\ndescription: {'x' * 1025}\n---\n", "description has 1025 characters"),
        (GOOD.format(name="things") + "line\n" * 300, "keep it below 300"),
    ],
)
def test_what_breaks_the_format_is_refused(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(SkillError, match=said) as caught:
        skills(written(tmp_path, text))
    assert "things/SKILL.md" in str(caught.value)


def test_a_name_that_is_no_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SkillError, match="lower-case letters"):
        skills(written(tmp_path, GOOD.format(name="Big_Things"), "Big_Things"))


def test_the_shipped_ones_are_read_once_in_order() -> None:
    assert skills() is skills(skills_folder())
    names = [skill.name for skill in skills()]
    assert names == sorted(names) and "floating-bodies" in names
