#include <algorithm>
#include <map>

#include "io/case_files/case_document.h"
#include "io/case_files/key.h"

namespace flexmorph::io {
namespace {

using Kind = CaseNode::Kind;
/// Former names and the present ones.
using Names = std::map<std::string, std::string>;

/// Former names of the keys and of the words of one kind of table.
struct FormerNames {
  Names keys;
  std::map<std::string, Names> words;  ///< By the present name of the key.
};

std::map<std::string, FormerNames> former_names_by_table() {
  std::map<std::string, FormerNames> out;
  for (const Key& key : all_keys())
    for (const std::string& table : key.tables) {
      for (const std::string& old : key.former_names) out[table].keys.emplace(old, key.name);
      for (const auto& [old, now] : key.renamings) {
        // The words of a table with free names are its names.
        if (key.name == "*")
          out[table].keys.emplace(old, now);
        else
          out[table].words[key.name].emplace(old, now);
      }
    }
  return out;
}

class Renaming {
 public:
  explicit Renaming(std::vector<std::string>& messages) : messages_(messages) {}

  void table(CaseNode& node, const std::string& kind, const std::string& path) {
    const auto found = book_.find(kind);
    if (found != book_.end()) keys(node, found->second, path);
    for (CaseNode& child : node.entries) {
      const std::string full = path.empty() ? child.key : path + "." + child.key,
                        below = kind.empty() ? child.key : kind + "." + child.key;
      if (child.kind == Kind::table) table(child, below, full);
      if (child.kind != Kind::list) continue;
      const std::vector<std::string> paths = entry_paths(child, full);
      for (size_t i = 0; i < child.entries.size(); ++i)
        if (child.entries[i].kind == Kind::table) table(child.entries[i], below, paths[i]);
    }
  }

 private:
  void keys(CaseNode& node, const FormerNames& names, const std::string& path) {
    for (size_t k = 0; k < node.entries.size();) {
      CaseNode& child = node.entries[k];
      const auto renamed = names.keys.find(child.key);
      if (renamed != names.keys.end()) {
        CaseNode* present = node.find(renamed->second);
        if (present && !child.is_option) {  // both are in the file: the old one is an unknown key
          ++k;
          continue;
        }
        report(child, path, "the key", renamed->second);
        child.key = renamed->second;
        if (present) {
          *present = std::move(child);
          node.entries.erase(node.entries.begin() + static_cast<std::ptrdiff_t>(k));
          continue;
        }
      }
      if (const auto words = names.words.find(child.key); words != names.words.end()) {
        word(child, words->second, path);
        for (CaseNode& entry : child.entries) word(entry, words->second, path);
      }
      ++k;
    }
  }

  void word(CaseNode& node, const Names& words, const std::string& path) {
    if (node.kind != Kind::text) return;
    const auto renamed = words.find(node.text);
    if (renamed == words.end()) return;
    report(node, path, "'" + node.text + "'", "'" + renamed->second + "'");
    node.text = renamed->second;
  }

  void report(const CaseNode& node, const std::string& path, const std::string& old,
              const std::string& now) {
    const std::string full = path.empty() || node.key.empty() ? path + node.key
                                                              : path + "." + node.key,
                      message = located(node, full) + ": " + old + " is now called " + now +
                                "; the next version will not read the former name";
    if (std::find(messages_.begin(), messages_.end(), message) == messages_.end())
      messages_.push_back(message);
  }

  const std::map<std::string, FormerNames> book_ = former_names_by_table();
  std::vector<std::string>& messages_;
};

}  // namespace

void CaseDocument::rename_former_names() { Renaming(former_names).table(root, "", ""); }

}  // namespace flexmorph::io
