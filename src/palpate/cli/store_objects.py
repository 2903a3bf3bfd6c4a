"""`palpate store objects` and `palpate store object`: what is known of objects, and changing it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.invisible import shown

__all__ = ["app", "objects"]

app = typer.Typer(help="Show or describe one object, tell what is known of it, merge or split it, undo that.")

Name = Annotated[str, typer.Argument(metavar="OBJECT", help="Name, common name, alias or DATASET/NAME.")]
Who = Annotated[str | None, typer.Option("--who", help="Who decided it (default: whoever is logged in).")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@app.callback()
def object_() -> None:
    """Show or describe one object, tell what is known of it, merge or split it, undo that."""


@spread
def objects(place: Place, as_json: Json = False) -> None:
    """List objects, and what is known of each."""
    from palpate.cli.object_view import things_json, things_table
    from palpate.cli.storing import LeftOut
    from palpate.cli.terminal import print_whole
    from palpate.store.things import list_things

    left = LeftOut()
    with place.opened() as store:
        found = list_things(store, left.damaged.append)
    if as_json:
        print(things_json(found))
    elif found or left.damaged:
        print_whole(things_table(found))
    else:
        print("no objects yet")
    left.tell()


@app.command("show")
@spread
def show(
    name: Name,
    place: Place,
    images: Annotated[Path | None, typer.Option("--images", metavar="FOLDER", help="Write its pictures there.")] = None,
    as_json: Json = False,
) -> None:
    """Show an object: description, known properties, images, and what was measured by property and device."""
    from palpate.cli.knowing import save_images
    from palpate.cli.object_view import thing_json, thing_view
    from palpate.cli.terminal import print_whole
    from palpate.store.audit import history
    from palpate.store.measured import measured_of
    from palpate.store.things import find_thing

    with place.opened() as store:
        thing = find_thing(store, name)
        measured, changes = measured_of(store, thing.ref), history(store, thing.ref)
        if images is not None:
            save_images(store, thing, images)
    if as_json:
        print(thing_json(thing, measured, changes))
    else:
        print_whole(thing_view(thing, measured, changes))


@app.command("add")
@spread
def add(
    path: Annotated[str, typer.Argument(metavar="DATASET/NAME", help="The dataset, and the object's name there.")],
    place: Place,
    who: Who = None,
) -> None:
    """Put an object into the store before it is measured."""
    from palpate.cli.knowing import who_of
    from palpate.errors import PalpateError
    from palpate.store.describing import add_thing
    from palpate.store.records import ThingRef

    dataset, slash, name = path.partition("/")
    if not slash:
        raise PalpateError(f"{path!r} was found, expected DATASET/NAME")
    with place.opened(make=True) as store:
        new = add_thing(store, ThingRef(dataset, name), who=who_of(who))
    print(shown(f"{path}: {'added' if new else 'is there already'}"))


@app.command("set")
@spread
def set_(
    name: Name,
    place: Place,
    maker: Annotated[str | None, typer.Option("--maker", help="Who makes it.")] = None,
    common_name: Annotated[str | None, typer.Option("--common-name", help="What it is called.")] = None,
    alias: Annotated[list[str] | None, typer.Option("--alias", help="Another name; may be repeated.")] = None,
    attribute: Annotated[
        list[str] | None, typer.Option("--attribute", help="NAME=VALUE, as JSON or text; may be repeated.")
    ] = None,
    image: Annotated[list[Path] | None, typer.Option("--image", help="A picture; may be repeated.")] = None,
    remove: Annotated[
        list[str] | None,
        typer.Option("--remove", help="maker, common-name, alias:NAME, attribute:NAME or image:NAME; may be repeated."),
    ] = None,
    who: Who = None,
) -> None:
    """Describe an object; what is not given stays as it is."""
    from palpate.cli.knowing import attributes_of, images_of, removed, who_of
    from palpate.store.describing import change_thing
    from palpate.store.things import Thing, find_thing

    attributes = attributes_of(attribute or [])
    with place.opened() as store:
        thing = find_thing(store, name)
        pictures = images_of(store, image or [])

        def edit(found: Thing) -> Thing:
            for text in remove or []:
                found = removed(found, text)
            for picture in pictures:
                found = found.showing(picture)
            return found.described(
                maker=maker or found.ref.maker,
                common_name=common_name or found.ref.common_name,
                aliases=tuple(dict.fromkeys((*found.ref.aliases, *(alias or [])))),
                attributes={**found.ref.attributes, **attributes},
            )

        changed = change_thing(store, thing.ref, edit, who=who_of(who))
    print(shown(f"{thing.path}: {'changed' if changed != thing else 'nothing to change'}"))


# a number below zero is no option
@app.command("know", context_settings={"ignore_unknown_options": True})
@spread
def know(
    name: Name,
    property_: Annotated[str, typer.Argument(metavar="PROPERTY", help="What is known.")],
    value: Annotated[
        str,
        typer.Argument(
            metavar="VALUE", help="'118 g', '118 ± 2 g', 'above 95 kPa', '90 to 100 kPa', a label, or LABEL=P,..."
        ),
    ],
    source: Annotated[str, typer.Option("--source", help="From where: a data sheet, a scale, a person.")],
    place: Place,
    sd: Annotated[float | None, typer.Option("--sd", min=0, help="SD of a value, in its unit.")] = None,
    who: Who = None,
) -> None:
    """Tell what is known of a property, in place of what that source said before."""
    from palpate.cli.knowing import who_of
    from palpate.cli.known_values import check_fits, entry_of
    from palpate.cli.store_view import entry_words
    from palpate.store.describing import change_thing
    from palpate.store.things import find_thing

    entry = entry_of(property_, value, sd)
    with place.opened() as store:
        thing = find_thing(store, name)
        check_fits(store, entry, value.strip())
        change_thing(store, thing.ref, lambda found: found.knowing(entry, source), who=who_of(who))
    print(shown(f"{thing.path}: {entry_words(entry)} ({source})"))
    for one in thing.known:
        if (one.entry.property, one.source) == (property_, source) and one.entry != entry:
            print(shown(f"- in place of {entry_words(one.entry)}"))


@app.command("forget")
@spread
def forget(
    name: Name,
    property_: Annotated[str, typer.Argument(metavar="PROPERTY", help="What is no longer known.")],
    place: Place,
    source: Annotated[str | None, typer.Option("--source", help="Only what this source said.")] = None,
    who: Who = None,
) -> None:
    """Take away what is known of a property."""
    from palpate.cli.knowing import who_of
    from palpate.errors import PalpateError
    from palpate.store.describing import change_thing
    from palpate.store.things import find_thing
    from palpate.wording import plural

    with place.opened() as store:
        thing = find_thing(store, name)
        left = thing.without(property_, source)
        if left == thing:
            raise PalpateError(
                f"{thing.path}: nothing is known of {property_!r}{f' from {source!r}' if source else ''}"
            )
        change_thing(store, thing.ref, lambda found: found.without(property_, source), who=who_of(who))
    print(shown(f"{thing.path}: {plural(len(thing.known) - len(left.known), 'item')} forgotten"))


@app.command("merge")
@spread
def merge(
    name: Name,
    into: Annotated[str, typer.Argument(metavar="INTO", help="The object that it is.")],
    place: Place,
    who: Who = None,
) -> None:
    """Count an object as another one; no recording is changed."""
    from palpate.cli.knowing import who_of
    from palpate.store.merging import merge_things
    from palpate.store.things import find_thing

    with place.opened() as store:
        thing, other = find_thing(store, name), find_thing(store, into)
        merge_things(store, thing.ref, other.ref, who=who_of(who))
    print(shown(f"{thing.path} counts as {other.path}"))


@app.command("split")
@spread
def split(name: Name, place: Place, who: Who = None) -> None:
    """Make an object that was merged one of its own again."""
    from palpate.cli.knowing import who_of
    from palpate.store.merging import split_thing
    from palpate.store.things import find_thing

    with place.opened() as store:
        thing = find_thing(store, name)
        split_thing(store, thing.ref, who=who_of(who))
    print(shown(f"{thing.path} is an object of its own"))


@app.command("undo")
@spread
def undo(name: Name, place: Place, who: Who = None) -> None:
    """Take back the last change of an object that holds; again, the one before."""
    from palpate.cli.knowing import who_of
    from palpate.cli.object_view import change_lines
    from palpate.store.things import find_thing
    from palpate.store.undoing import undo as take_back

    with place.opened() as store:
        thing = find_thing(store, name)
        change = take_back(store, thing.ref, who=who_of(who))
    by = "" if change.who is None else f" by {change.who}"
    print(shown(f"{thing.path}: taken back what was {change.what}{by} at {change.at:%Y-%m-%d %H:%M:%S} UTC"))
    for line in change_lines(change.detail):
        print(shown(f"- {line}"))
