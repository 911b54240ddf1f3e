"""The texts that common mistakes get are those of mistakes.md; make mistakes writes it anew."""

import unittest

import mistakes


class Mistakes(unittest.TestCase):
    def test_page(self):
        """Each mistake, one after the other, and no other ones."""
        kept, now = mistakes.rows(), mistakes.texts()
        self.assertEqual(list(kept), [mistakes.cell(code) for code in now], "make mistakes")
        for code, text in now.items():
            with self.subTest(code):
                self.assertEqual(mistakes.cell(text), kept[mistakes.cell(code)][1], "make mistakes")
        before = {code: kept[mistakes.cell(code)][0].replace("\\|", "|") for code in now}
        self.assertEqual(mistakes.page(before, now), mistakes.PAGE.read_text())

    def test_texts(self):
        """No text of Python speaks of macros of C, and every number has its mistakes."""
        self.assertEqual(len(mistakes.MISTAKES), 30)
        for code, (_, now) in mistakes.rows().items():
            with self.subTest(code):
                self.assertNotRegex(now, "DBL_EPSILON|object at 0x|unknown status")
                self.assertNotEqual(now, "")


if __name__ == "__main__":
    unittest.main()
