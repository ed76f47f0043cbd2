#include <cstdlib>

#include "io/case_files/case_document.h"

namespace flexmorph::io {
namespace {

std::string without_spaces(std::string text) {
  std::erase(text, ' ');
  return text;
}

/// Tells whether a value of the file is the default of its key.
bool is_fallback(const CaseNode& node, const std::string& fallback) {
  if (node.kind == CaseNode::Kind::number || node.kind == CaseNode::Kind::integer)
    return node.number == std::strtod(fallback.c_str(), nullptr);
  if (node.kind == CaseNode::Kind::text) return "\"" + node.text + "\"" == fallback;
  return without_spaces(node.shown) == without_spaces(fallback);
}

void add_settings(const CaseNode& node, const std::string& path, std::vector<Setting>& out);

void add_table(const CaseNode& table, const std::string& path, std::vector<Setting>& out) {
  for (const CaseNode& child : table.entries) {
    const std::string full = path.empty() ? child.key : path + "." + child.key;
    if (child.kind == CaseNode::Kind::table || !child.entries.empty())
      add_settings(child, full, out);
    for (const CaseNote& note : table.notes) {
      if (note.key != child.key || child.kind == CaseNode::Kind::table) continue;
      const bool differs = !note.fallback.empty() && !is_fallback(child, note.fallback);
      if (differs || child.is_option)
        out.push_back({full, child.shown, note.fallback, note.sentence, child.is_option});
    }
  }
}

void add_settings(const CaseNode& node, const std::string& path, std::vector<Setting>& out) {
  if (node.kind == CaseNode::Kind::table) return add_table(node, path, out);
  const std::vector<std::string> paths = entry_paths(node, path);
  for (size_t i = 0; i < node.entries.size(); ++i)
    if (node.entries[i].kind == CaseNode::Kind::table) add_table(node.entries[i], paths[i], out);
}

}  // namespace

std::vector<Setting> CaseDocument::settings() const {
  std::vector<Setting> out;
  add_table(root, "", out);
  return out;
}

}  // namespace flexmorph::io
