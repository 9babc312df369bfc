"""What people say leads to the asset that they mean, and a word for something else leads nowhere."""

import pytest

from wsim.assets import load_catalogue, search

MEANT = [
    ("desk", "desk", "id"),
    ("Desk", "desk", "id"),
    ("  the desk. ", "desk", "id"),
    ("desks", "desk", "stem"),
    ("workstation", "desk", "name"),
    ("table", "table", "id"),
    ("tables", "table", "stem"),
    ("dining table", "table", "name"),
    ("kitchen tables", "table", "stem"),
    ("an old round table", "table", "phrase"),
    ("chair", "chair", "id"),
    ("three wooden chairs", "chair", "phrase"),
    ("seat", "chair", "name"),
    ("benches", "bench", "stem"),
    ("park benches", "bench", "stem"),
    ("bookcase", "shelf", "name"),
    ("bookshelves", "shelf", "stem"),
    ("shelves", "shelf", "name"),
    ("a tall bookshelf", "shelf", "phrase"),
    ("cupboards", "cabinet", "stem"),
    ("sideboard", "cabinet", "name"),
    ("notebook computer", "laptop", "name"),
    ("notebooks", "laptop", "stem"),
    ("lap top", "laptop", "stem"),
    ("computer", "laptop", "words"),
    ("screen", "monitor", "name"),
    ("flat screen", "monitor", "name"),
    ("tv", "monitor", "name"),
    ("desk lamp", "lamp", "name"),
    ("a lamp on a desk", "lamp", "phrase"),
    ("coffee cup", "mug", "name"),
    ("coffee cups", "mug", "stem"),
    ("cup of tea", "mug", "phrase"),
    ("mugs", "mug", "stem"),
    ("soup bowls", "bowl", "stem"),
    ("pail", "bucket", "name"),
    ("red bucket full of water", "bucket", "phrase"),
    ("keg", "barrel", "name"),
    ("oak barrels", "barrel", "phrase"),
    ("packing case", "crate", "name"),
    ("boxes", "cardboard_box", "words"),
    ("flower pot", "plant", "name"),
    ("houseplants", "plant", "stem"),
    ("wooden board", "plank", "name"),
    ("inclined plane", "ramp", "name"),
    ("see saw", "seesaw", "name"),
    ("CoffeeCup", "mug", "name"),
    ("coffee_cup", "mug", "name"),
    ("teeter totters", "seesaw", "stem"),
    ("dominoes", "domino", "stem"),
    ("dominos", "domino", "stem"),
    ("euro pallets", "pallet", "stem"),
    ("tabel", "table", "fuzzy"),
    ("laptp", "laptop", "fuzzy"),
    ("a wooden buket", "bucket", "fuzzy"),
    ("cofee mug", "mug", "phrase"),
    ("tableware for soup", "bowl", "words"),
]


@pytest.mark.parametrize(("words", "id", "kind"), MEANT, ids=[words.strip() for words, _, _ in MEANT])
def test_first_hit(words: str, id: str, kind: str) -> None:
    hits = search(words)
    assert (hits[0].asset.id, hits[0].kind) == (id, kind), hits[0]
    assert hits[0].matched
    assert [hit.score for hit in hits] == sorted((hit.score for hit in hits), reverse=True)


@pytest.mark.parametrize(
    "words", ["", "  ", "the", "?!", "elephant", "wooden violin", "water", "xyzzy", "mu", "robot arm"]
)
def test_nothing_of_the_kind(words: str) -> None:
    assert search(words) == []


@pytest.mark.parametrize("id", load_catalogue())
def test_every_name_leads_to_its_asset(id: str) -> None:
    asset = load_catalogue()[id]
    assert search(id)[0].score == 1.0
    for name in asset.names:
        assert search(name)[0].asset.id == id, name


def test_better_matches_score_higher() -> None:
    scores = [search(words)[0].score for words in ("mug", "coffee cup", "coffee cups", "old coffee cup", "cofee cupp")]
    assert scores == sorted(scores, reverse=True) and len(set(scores)) == len(scores)


def test_category_finds_all_of_it() -> None:
    assert {hit.asset.id for hit in search("furniture", limit=20)} >= {"bench", "cabinet", "chair", "desk", "shelf"}


def test_limit() -> None:
    assert len(search("furniture", limit=2)) == 2
    with pytest.raises(ValueError, match="limit = 0"):
        search("desk", limit=0)
