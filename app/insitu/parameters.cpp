#include "app/insitu/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace gs::app::insitu {
namespace {

bool is_parameter_name(std::string_view name) {
  constexpr std::size_t kMaxBytes = 63;
  return !name.empty() && name.size() <= kMaxBytes && name != "field" && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

// Decodes %XX and '+' of a query. Returns nullopt for invalid texts.
std::optional<std::string> query_text(std::string_view coded) {
  std::string text;
  for (std::size_t i = 0; i < coded.size(); ++i) {
    if (coded[i] != '%') {
      text += coded[i] == '+' ? ' ' : coded[i];
      continue;
    }
    unsigned byte = 0;
    if (i + 2 >= coded.size()) return std::nullopt;
    const auto [end, error] = std::from_chars(&coded[i + 1], &coded[i + 1] + 2, byte, 16);
    if (error != std::errc() || end != &coded[i + 1] + 2) return std::nullopt;
    text += static_cast<char>(byte);
    i += 2;
  }
  return text;
}

std::string in_words(double number) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, number);
  return {text, end};
}

}  // namespace

std::optional<std::string> Parameters::add(const gs_insitu_parameter& parameter) {
  Parameter made;
  made.name = parameter.name ? parameter.name : "";
  made.label = parameter.label ? parameter.label : made.name;
  made.unit = parameter.unit ? parameter.unit : "";
  made.minimum = parameter.minimum;
  made.maximum = parameter.maximum;
  made.value = made.wanted = parameter.value;
  made.integer = parameter.integer != 0;
  const std::string named = "parameter '" + made.name + "': ";
  if (!is_parameter_name(made.name))
    return named + "the name is invalid; expected 1 to 63 letters, digits and '_', but not 'field'";
  if (!std::isfinite(made.minimum) || !std::isfinite(made.maximum) || !(made.minimum <= made.maximum))
    return named + "the range is invalid; expected minimum <= maximum";
  if (!(made.value >= made.minimum && made.value <= made.maximum))
    return named + "the value is outside of its range; expected minimum <= value <= maximum";
  const std::lock_guard lock(mutex_);
  if (parameters_.size() >= kMaxParameters) return named + "there are 64 parameters already";
  for (const Parameter& other : parameters_)
    if (other.name == made.name) return named + "a parameter has this name already";
  parameters_.push_back(std::move(made));
  return std::nullopt;
}

std::optional<double> Parameters::value(std::string_view name) const {
  const std::lock_guard lock(mutex_);
  for (const Parameter& parameter : parameters_)
    if (parameter.name == name) return parameter.value;
  return std::nullopt;
}

std::size_t Parameters::size() const {
  const std::lock_guard lock(mutex_);
  return parameters_.size();
}

std::vector<double> Parameters::take_wanted() {
  const std::lock_guard lock(mutex_);
  std::vector<double> values;
  for (Parameter& parameter : parameters_) values.push_back(parameter.value = parameter.wanted);
  return values;
}

void Parameters::set(const std::vector<double>& values) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < std::min(values.size(), parameters_.size()); ++i) parameters_[i].value = values[i];
}

std::optional<std::string> Parameters::set_wanted(std::string_view query) {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::size_t, double>> changes;
  std::optional<std::string> field;
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(pair.size() + 1, query.size()));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const auto name = query_text(pair.substr(0, equals));
    const auto text = query_text(pair.substr(std::min(equals + 1, pair.size())));
    if (!name || !text) return "the query is invalid; expected NAME=VALUE pairs with '&' between them";
    if (*name == "field") {
      if (std::ranges::find(fields_, *text) == fields_.end()) return "there is no such field";
      field = *text;
      continue;
    }
    const auto found = std::ranges::find(parameters_, *name, &Parameter::name);
    if (found == parameters_.end()) return "there is no such parameter";
    double value = 0;
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
    if (error != std::errc() || end != text->data() + text->size() || !std::isfinite(value))
      return found->name + ": the value is not a number; expected a number such as 0.5";
    if (value < found->minimum || value > found->maximum)
      return found->name + ": the value is out of range; expected " + in_words(found->minimum) + " to " +
             in_words(found->maximum);
    if (found->integer && value != std::round(value)) return found->name + ": expected a whole number";
    changes.emplace_back(found - parameters_.begin(), value);
  }
  for (const auto& [place, value] : changes) parameters_[place].wanted = value;
  if (field) field_ = *field;
  return std::nullopt;
}

void Parameters::set_fields(std::vector<std::string> fields, const std::string& shown) {
  const std::lock_guard lock(mutex_);
  fields_ = std::move(fields);
  shown_ = shown;
}

std::string Parameters::field() const {
  const std::lock_guard lock(mutex_);
  return field_;
}

void Parameters::describe(JsonValue& json) const {
  const std::lock_guard lock(mutex_);
  JsonValue all = JsonValue::list(), fields = JsonValue::list();
  for (const Parameter& one : parameters_)
    all.add(JsonValue::named({{"name", one.name},
                              {"label", one.label},
                              {"unit", one.unit},
                              {"minimum", one.minimum},
                              {"maximum", one.maximum},
                              {"value", one.wanted},
                              {"integer", one.integer}}));
  for (const std::string& field : fields_) fields.add(field);
  json.put("parameters", std::move(all));
  json.put("fields", std::move(fields));
  json.put("field", field_.empty() ? shown_ : field_);
}

}  // namespace gs::app::insitu
