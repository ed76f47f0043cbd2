#include "cases/keys/book.h"
#include "geometry/base.h"

/// The reference of keys as a section of cases/docs/keys.md.
namespace flexmorph::cases {
namespace {

/// Returns a text for a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

}  // namespace

std::string keys_as_markdown() {
  std::string out = std::string(kNumbersSentence) + "\n";
  for (const KeyTable& table : key_book()) {
    out += "\n#### " + table.title() + "\n\n";
    if (table.own) out += table.own->sentence + "\n\n";
    out += "| key | value | default | description |\n| --- | --- | --- | --- |\n";
    for (const io::Key* key : table.keys)
      out += "| `" + shown_name(*key) + "` | " + cell(type_text(*key)) + " | " +
             cell(default_text(*key)) + " | " + cell(sentence_of(*key)) + " |\n";
    const auto meanings = meanings_of(table);
    if (!meanings.empty()) out += "\n";
    for (const WordMeanings& each : meanings) {
      for (const auto& [word, sentence] : each.words)
        out += "- `" + each.key + " = \"" + word + "\"`: " + sentence + "\n";
      if (each.words.empty()) out += "- `" + each.key + "`: " + each.reference() + "\n";
    }
  }
  return out;
}

std::string with_section(const std::string& text, const std::string& name,
                         const std::string& section) {
  const std::string first =
                        "<!-- " + name +
                        ": made by `flexmorph keys --renew cases/docs/keys.md` from here on -->\n",
                    last = "<!-- " + name + ": to here -->\n";
  const size_t begin = text.find(first), end = text.find(last);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw Error::input(
        std::string("a file with the lines\n") + first + last +
        "is needed, because the reference is written between these lines; this file lacks them");
  return text.substr(0, begin) + first + "\n" + section + "\n" + text.substr(end);
}

}  // namespace flexmorph::cases
