#include "io/case_files/case_document.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>

#include "geometry/base.h"
#include "geometry/text.h"
#include "io/case_files/case_forms.h"
#include "io/case_files/case_parser.h"
#include "io/case_files/other_terms.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

constexpr const char* kOption = "--set ";

/// Returns the number of edits (insertion, deletion, exchange, swap of neighbours) that turn a into
/// b.
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const size_t exchange = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, exchange});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::vector<std::string> split_key(const std::string& key, const std::string& option) {
  std::vector<std::string> parts;
  std::istringstream in(key);
  for (std::string part; std::getline(in, part, '.');) parts.push_back(part);
  if (parts.empty() || key.back() == '.' || !std::all_of(parts.begin(), parts.end(), is_bare_key))
    throw Error::input(option + ": KEY is a path with dots, such as body.thickness");
  return parts;
}

std::string trimmed(const std::string& s) {
  const size_t first = s.find_first_not_of(" \t"), last = s.find_last_not_of(" \t");
  return first == std::string::npos ? "" : s.substr(first, last - first + 1);
}

/// Returns the entry of a list that KEY means; if KEY names the entry, `next` skips the name.
CaseNode& entry_of(CaseNode& list, const std::string& so_far, const std::vector<std::string>& keys,
                   size_t& next, const std::string& option) {
  const std::vector<std::string> labels = entry_labels(list);
  for (size_t i = 0; i < list.entries.size(); ++i) {
    const std::string& label = labels[i];
    if (next + 1 < keys.size() && (keys[next] == label || keys[next] == std::to_string(i))) {
      ++next;
      return list.entries[i];
    }
  }
  if (list.entries.size() == 1) return list.entries[0];
  throw Error::input(option + ": " + so_far + " has " + std::to_string(list.entries.size()) +
                     " entries; write " + so_far + ".ENTRY.KEY, where ENTRY is one of " +
                     joined(labels));
}

/// Removes the entry of this label or number from a list of tables. @return false: there is none
bool remove_entry(CaseNode& list, const std::string& entry) {
  const std::vector<std::string> labels = entry_labels(list);
  for (size_t i = 0; i < labels.size(); ++i)
    if (entry == labels[i] || entry == std::to_string(i)) {
      list.entries.erase(list.entries.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
  return false;
}

void collect_unknown(const CaseNode& node, const std::string& path,
                     std::vector<Complaint>& messages) {
  if (node.kind == CaseNode::Kind::list) {
    const auto may_hold_keys = [](const CaseNode& entry) {
      return entry.kind == CaseNode::Kind::table || entry.kind == CaseNode::Kind::list;
    };
    if (std::none_of(node.entries.begin(), node.entries.end(), may_hold_keys)) return;
    const std::vector<std::string> paths = entry_paths(node, path);
    for (size_t i = 0; i < node.entries.size(); ++i)
      collect_unknown(node.entries[i], paths[i], messages);
    return;
  }
  if (node.kind != CaseNode::Kind::table || !node.visited) return;
  const std::vector<std::string> known(node.asked.begin(), node.asked.end());
  for (const CaseNode& child : node.entries) {
    const std::string& key = child.key;
    const std::string full = path.empty() ? key : path + "." + key;
    if (node.asked.contains(key)) {
      collect_unknown(child, full, messages);
      continue;
    }
    std::string message = ": unknown key";
    if (const std::string close = nearest(key, known), answer = answer_to_key(key);
        !answer.empty()) {
      message += "; " + answer;
    } else if (!close.empty()) {
      message += ", did you mean '" + close + "'?";
    } else {
      message += "; the keys allowed here are " + joined(known);
    }
    messages.push_back({child.line, located(child, full), message});
  }
}

std::string written_key(const std::string& key) { return is_bare_key(key) ? key : in_quotes(key); }

bool is_list_of_tables(const CaseNode& node) {
  return node.kind == CaseNode::Kind::list && !node.entries.empty() &&
         std::all_of(node.entries.begin(), node.entries.end(), [](const CaseNode& entry) {
           return entry.kind == CaseNode::Kind::table && !entry.is_inline;
         });
}

/// Writes a document as TOML text, with or without the notes of readers.
struct Writer {
  bool explains;
  std::string out = {};

  /// Returns a value in one line.
  std::string written(const CaseNode& node) const {
    if (node.kind != CaseNode::Kind::table && node.kind != CaseNode::Kind::list) return node.shown;
    const bool is_table = node.kind == CaseNode::Kind::table;
    std::string text;
    for (const CaseNode& child : node.entries)
      text += (text.empty() ? "" : ", ") + (is_table ? written_key(child.key) + " = " : "") +
              written(child);
    for (const CaseNote& note : taken(node))
      text += (text.empty() ? "" : ", ") + note.key + " = " + note.value;
    return is_table ? "{ " + text + " }" : "[" + text + "]";
  }

  /// Returns the notes about values that readers used for keys which are not in the file.
  std::vector<CaseNote> taken(const CaseNode& table) const {
    std::vector<CaseNote> notes;
    for (const CaseNote& note : table.notes)
      if (explains && !note.value.empty()) notes.push_back(note);
    return notes;
  }

  void write_line(const std::string& text, const CaseNode& table, const std::string& key) {
    constexpr size_t kComments = 32;  // column in which comments begin
    out += text;
    for (const CaseNote& note : table.notes)
      if (explains && note.key == key && !note.sentence.empty())
        out += std::string(text.size() + 2 > kComments ? 2 : kComments - text.size(), ' ') + "# " +
               note.sentence;
    out += "\n";
  }

  void write_section(const CaseNode& child, const CaseNode& parent, const std::string& path) {
    const std::string full = (path.empty() ? "" : path + ".") + written_key(child.key);
    if (child.kind == CaseNode::Kind::table) {
      out += "\n";
      write_line("[" + full + "]", parent, child.key);
      write_table(child, full);
      return;
    }
    for (const CaseNode& entry : child.entries) {
      out += "\n";
      write_line("[[" + full + "]]", parent, child.key);
      write_table(entry, full);
    }
  }

  /// Writes a table: first its values, then the tables in it.
  void write_table(const CaseNode& table, const std::string& path) {
    const auto is_section = [](const CaseNode& node) {
      return is_list_of_tables(node) || (node.kind == CaseNode::Kind::table && !node.is_inline);
    };
    for (const CaseNode& child : table.entries)
      if (!is_section(child))
        write_line(written_key(child.key) + " = " + written(child), table, child.key);
    for (const CaseNote& note : taken(table))
      write_line(note.key + " = " + note.value, table, note.key);
    for (const CaseNode& child : table.entries)
      if (is_section(child)) write_section(child, table, path);
    for (const CaseNode& child : table.assumed)
      if (explains) write_section(child, table, path);
  }
};

}  // namespace

const CaseNode* CaseNode::find(const std::string& wanted) const {
  for (const CaseNode& node : entries)
    if (node.key == wanted) return &node;
  return nullptr;
}

CaseNode* CaseNode::find(const std::string& wanted) {
  return const_cast<CaseNode*>(std::as_const(*this).find(wanted));
}

void CaseNode::note(CaseNote note) const {
  const auto old = std::find_if(notes.begin(), notes.end(),
                                [&](const CaseNote& each) { return each.key == note.key; });
  CaseNote& location = old == notes.end() ? notes.emplace_back() : *old;
  location = std::move(note);
}

bool is_bare_key(const std::string& word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return (c < 128 && std::isalnum(c)) || c == '_' || c == '-';
  });
}

std::vector<std::string> entry_labels(const CaseNode& list) {
  const auto label = [](const CaseNode& entry) -> std::string {
    for (const char* key : {"name", "body"}) {
      const CaseNode* node = entry.find(key);
      if (node && node->kind == CaseNode::Kind::text) return node->text;
    }
    return "";
  };
  std::vector<std::string> out;
  std::map<std::string, int> times;
  for (const CaseNode& entry : list.entries) ++times[out.emplace_back(label(entry))];
  for (size_t i = 0; i < out.size(); ++i)
    if (!is_bare_key(out[i]) || times.at(out[i]) > 1) out[i] = std::to_string(i);
  return out;
}

std::vector<std::string> entry_paths(const CaseNode& list, const std::string& list_path) {
  if (list.entries.size() == 1) return {list_path};
  std::vector<std::string> out = entry_labels(list);
  for (std::string& each : out) each = list_path + "." + each;
  return out;
}

std::string nearest(const std::string& word, std::span<const std::string> known) {
  if (std::string term = word_for_term(word, known); !term.empty()) return term;
  std::string best;
  size_t best_distance = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const size_t distance = edit_distance(word, candidate);
    if (distance < best_distance && distance < candidate.size()) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string located(const CaseNode& node, const std::string& key_path) {
  constexpr size_t kMaxLineLength = 60;
  const bool computed = !node.text.empty() && (node.kind == CaseNode::Kind::number ||
                                               node.kind == CaseNode::Kind::integer);
  const std::string number = computed ? " (" + to_text(node.number) + ")" : "";
  if (node.is_option) return node.location + number;  // it contains key and value already
  if (node.kind == CaseNode::Kind::table) return node.location + ": [" + key_path + "]";
  if (is_list_of_tables(node)) return node.location + ": [[" + key_path + "]]";
  const bool fits = node.shown.size() <= kMaxLineLength;
  return node.location + ": " + key_path + " = " +
         (fits ? node.shown : node.shown.substr(0, kMaxLineLength - 3) + "...") + number;
}

CaseDocument::CaseDocument(const std::string& file) : CaseDocument(file, read_text(file)) {}

CaseDocument::CaseDocument(const std::string& file, std::string content)
    : path(file), text(std::move(content)), root(parse_case(text, file)) {}

void CaseDocument::apply(const std::string& change) {
  const std::string option = kOption + change;
  const size_t equals = change.find('=');
  if (equals == std::string::npos || change.find_first_of("\r\n") != std::string::npos)
    throw Error::input(option + ": an override has the form KEY=VALUE, on one line");
  const std::vector<std::string> keys = split_key(trimmed(change.substr(0, equals)), option);
  const std::string text_of_value = trimmed(change.substr(equals + 1));
  const bool removes = text_of_value.empty();
  CaseNode value = removes ? CaseNode() : parse_option(text_of_value, option);

  CaseNode* here = &root;
  std::string so_far;
  for (size_t next = 0; next + 1 < keys.size();) {
    const std::string& key = keys[next++];
    so_far += (so_far.empty() ? "" : ".") + key;
    CaseNode* node = here->find(key);
    if (!node && removes) return changes.push_back(change);
    if (!node) {
      CaseNode table;
      table.key = key;
      table.location = option;
      table.shown = "{...}";
      node = &here->entries.emplace_back(std::move(table));
    }
    if (is_list_of_tables(*node)) {
      if (removes && next + 1 == keys.size() && remove_entry(*node, keys[next])) {
        if (node->entries.empty())
          std::erase_if(here->entries, [&](const CaseNode& each) { return each.key == key; });
        return changes.push_back(change);
      }
      node = &entry_of(*node, so_far, keys, next, option);
    }
    if (node->kind != CaseNode::Kind::table)
      throw Error::input(option + ": " + so_far + " is not a table and has no keys");
    here = node;
  }
  value.key = keys.back();
  if (removes) {
    std::erase_if(here->entries, [&](const CaseNode& node) { return node.key == value.key; });
  } else if (CaseNode* old = here->find(value.key)) {
    *old = std::move(value);
  } else {
    here->entries.push_back(std::move(value));
  }
  changes.push_back(change);
}

void CaseDocument::refuse_unknown_keys() const {
  std::vector<Complaint> messages;
  collect_unknown(root, "", messages);
  if (!messages.empty()) throw Error::input(complaints_text(std::move(messages), path));
}

CaseDocument::Looked CaseDocument::look(const std::string& key_path) const {
  Looked out{&root, "", ""};
  std::istringstream in(key_path);
  for (std::string part; std::getline(in, part, '.');) {
    if (is_list_of_tables(*out.node)) {
      const CaseNode& list = *out.node;
      const size_t size = list.entries.size();
      size_t i = 0;
      const std::vector<std::string> labels = entry_labels(list);
      while (i < size && labels[i] != part && std::to_string(i) != part) ++i;
      const bool named = i < size;
      if (!named && size > 1) return out;
      if (size > 1) out.path += "." + labels[i];
      out.node = &list.entries[named ? i : 0];
      if (named) continue;
    }
    const CaseNode* child = out.node->find(part);
    if (child == nullptr) {
      out.next = part;
      return out;
    }
    out.node = child;
    out.path += (out.path.empty() ? "" : ".") + part;
  }
  out.whole = true;
  return out;
}

std::string CaseDocument::where(const std::string& key_path) const {
  const Looked found = look(key_path);
  for (const CaseNote& note : found.node->notes)
    if (!found.whole && note.key == found.next && !note.value.empty())
      return found.node->location + ": " + (found.path.empty() ? "" : found.path + ".") + note.key +
             " = " + note.value + " (not given)";
  return found.path.empty() ? root.location : located(*found.node, found.path);
}

std::string CaseDocument::effective_text() const {
  if (changes.empty()) return text;
  std::string out = "# " + std::filesystem::path(path).filename().string() + ", changed by";
  for (const std::string& change : changes) out += "\n#   " + (kOption + change);
  out += "\n\n";
  Writer writer{.explains = false};
  writer.write_table(root, "");
  return out + writer.out;
}

std::string CaseDocument::explained_text() const {
  Writer writer{.explains = true};
  writer.write_table(root, "");
  return "# This case file contains all values of the run, including those that were not "
         "given.\n\n" +
         writer.out;
}

}  // namespace flexmorph::io
