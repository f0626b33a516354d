"""What of a scene is not rendered as it is in Blender, by the name of the thing: nothing is left out in silence."""


class Notes:
    def __init__(self):
        self._names = {}  # text -> names, in the order in which they came

    def add(self, name, text):
        """`text` says what is lost of the thing called `name`, and what it is instead."""
        names = self._names.setdefault(text, [])
        if name not in names:
            names.append(name)

    def lines(self):
        """One line per kind of loss: all names, then what happened to them."""
        return [", ".join(names) + ": " + text for text, names in self._names.items()]
