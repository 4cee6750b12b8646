from core.schema.report import PairReport
from core.validation.nesting import nest


def pair(a, b, relation):
    return PairReport(a=a, b=b, relation=relation, intersecting_pairs=0, case_1=0, case_2=0, case_3=0, min_gap_mm=1.0)


def test_the_closest_holder_is_the_parent():
    pairs = [
        pair("brain", "skin", "a_inside_b"),
        pair("skin", "skull", "b_inside_a"),
        pair("brain", "skull", "a_inside_b"),
        pair("brain", "eye", "disjoint"),
        pair("eye", "skin", "a_inside_b"),
        pair("eye", "skull", "disjoint"),
    ]
    assert nest(["brain", "skin", "skull", "eye"], pairs) == {"brain": "skull", "skin": None, "skull": "skin", "eye": "skin"}


def test_unrelated_meshes_have_no_parent():
    assert nest(["a", "b"], [pair("a", "b", "intersecting")]) == {"a": None, "b": None}
    assert nest(["a"], []) == {"a": None}
