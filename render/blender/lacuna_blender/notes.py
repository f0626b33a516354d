"""Notes about everything in a scene that is not rendered as in Blender, by name: nothing is left out silently."""


class Notes:
    def __init__(self):
        self._names = {}  # text -> names, in the order in which they came

    def add(self, name, text):
        """Adds a note. `text` tells what is lost of the thing called `name`, and what is rendered instead."""
        names = self._names.setdefault(text, [])
        if name not in names:
            names.append(name)

    def lines(self):
        """One line per kind of loss: all names, then what happened to them."""
        return [", ".join(names) + ": " + text for text, names in self._names.items()]
