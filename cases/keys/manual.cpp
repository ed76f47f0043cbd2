#include "cases/keys/manual.h"

#include "cases/keys/book.h"
#include "cases/scene/version.h"

namespace flexmorph::cases {

std::string manual_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool begins = out.empty() || out.back() == '\n';
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string manual_head(const std::string& section, const std::string& title) {
  return ".TH FLEXMORPH " + section + " \"\" \"Flexmorph " + kVersion +
         "\"\n.SH NAME\nflexmorph \\- " + manual_text(title) + "\n";
}

std::string keys_as_manual() {
  std::string out = manual_head("5", "case files of flexmorph");
  out +=
      ".SH DESCRIPTION\nA case file describes a mechanism, the design of its plates and the "
      "output of a run in TOML.\n.P\n" +
      manual_text(kNumbersSentence) + "\n";
  for (const KeyTable& table : key_book()) {
    out += ".SH \"" + manual_text(table.title()) + "\"\n";
    if (table.own) out += manual_text(table.own->sentence) + "\n";
    for (const io::Key* key : table.keys) {
      const std::string preset = default_text(*key);
      out += ".TP\n.B " + manual_text(shown_name(*key)) + "\n" + manual_text(type_text(*key)) +
             (preset == "required" ? ", required" : "; default: " + manual_text(preset)) + ".\n" +
             manual_text(sentence_of(*key)) + "\n";
    }
    for (const WordMeanings& each : meanings_of(table)) {
      for (const auto& [word, sentence] : each.words)
        out += ".TP\n.B " + manual_text(each.key + " = \"" + word + "\"") + "\n" +
               manual_text(sentence) + "\n";
      if (each.words.empty())
        out += ".TP\n.B " + manual_text(each.key) + "\n" + manual_text(each.reference()) + "\n";
    }
  }
  return out + ".SH SEE ALSO\n.BR flexmorph (1)\n";
}

}  // namespace flexmorph::cases
