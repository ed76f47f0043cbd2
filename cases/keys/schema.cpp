#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/keys/book.h"
#include "io/json.h"

/// The reference of keys as a JSON schema, for editors of TOML files.
namespace flexmorph::cases {
namespace {

using Json = nlohmann::ordered_json;
using Kind = io::Form::Kind;

Json schema_of_table(const std::string& path);

std::string below(const std::string& path, const io::Key& key) {
  return path.empty() ? key.name : path + "." + key.name;
}

Json number_schema(const io::Quantity& q) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  Json out{{"type", {"number", "string"}}};  // limits of numbers do not apply to texts
  if (q.lower > -kUnlimited) out[q.lower_open ? "exclusiveMinimum" : "minimum"] = q.lower;
  if (q.upper < kUnlimited) out[q.upper_open ? "exclusiveMaximum" : "maximum"] = q.upper;
  return out;
}

Json value_schema(const io::Form& form, const std::string& path) {
  switch (form.kind) {
    case Kind::number:
      return number_schema(form.quantity);
    case Kind::integer:
      return {{"type", {"integer", "string"}}, {"minimum", form.lower}, {"maximum", form.upper}};
    case Kind::boolean:
      return {{"type", "boolean"}};
    case Kind::text:
      return {{"type", "string"}};
    case Kind::table:
      return schema_of_table(path);
    case Kind::tables:
      return {{"type", "array"}, {"items", schema_of_table(path)}};
    case Kind::word:
      break;
  }
  Json out{{"type", "string"}};
  if (form.allowed) out["enum"] = form.words();
  return out;
}

Json list_schema(Json items, int least, int most) {
  Json out{{"type", "array"}, {"items", std::move(items)}, {"minItems", least}};
  if (most > 0) out["maxItems"] = most;
  return out;
}

Json form_schema(const io::Form& form, const std::string& path) {
  Json out = value_schema(form, path);
  if (!form.or_name.empty()) out = {{"anyOf", {out, {{"type", "string"}}}}};
  if (form.columns > 0) out = list_schema(std::move(out), form.columns, form.columns);
  if (!form.is_list) return out;
  out = list_schema(std::move(out), form.least, form.most);
  if (form.kind == Kind::word) out["uniqueItems"] = true;
  return out;
}

Json default_of(const io::Value& value) {
  return std::visit([](const auto& each) { return Json(each); }, value);
}

/// Returns the schema of one key. The key may have several declarations with different conditions.
Json key_schema(const std::vector<const io::Key*>& keys, const std::string& path) {
  Json forms = Json::array();
  std::string description;
  for (const io::Key* key : keys) {
    for (const io::Form& form : key->forms) {
      Json each = form_schema(form, below(path, *key));
      if (std::find(forms.begin(), forms.end(), each) == forms.end())
        forms.push_back(std::move(each));
    }
    description +=
        (description.empty() ? "" : "\n") + sentence_of(*key) + " Value: " + type_text(*key) +
        ". Default: " + (key->is_needed() ? "none, the key is required" : default_text(*key)) + ".";
  }
  Json out = forms.size() == 1 ? forms[0] : Json{{"anyOf", forms}};
  out["description"] = description;
  if (keys.size() == 1 && keys[0]->fallback) out["default"] = default_of(*keys[0]->fallback);
  return out;
}

Json schema_of_table(const std::string& path) {
  std::map<std::string, std::vector<const io::Key*>> by_name;
  std::vector<std::string> names;
  for (const io::Key* key : table_of_keys(path).keys) {
    if (!by_name.contains(key->name)) names.push_back(key->name);
    by_name[key->name].push_back(key);
  }
  Json properties = Json::object(), required = Json::array();
  Json others = false;
  for (const std::string& name : names) {
    const std::vector<const io::Key*>& keys = by_name[name];
    if (name == "*") {
      others = key_schema(keys, path);
      continue;
    }
    properties[name] = key_schema(keys, path);
    if (keys.size() == 1 && keys[0]->is_needed() && keys[0]->condition.empty())
      required.push_back(name);
  }
  Json out{{"type", "object"}, {"properties", properties}, {"additionalProperties", others}};
  if (!required.empty()) out["required"] = required;
  return out;
}

}  // namespace

std::string keys_as_schema() {
  Json out{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Flexmorph case"}};
  out.update(schema_of_table(""));
  return io::json_text(out);
}

}  // namespace flexmorph::cases
