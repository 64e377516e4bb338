#include "base/json_value.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gs {

struct JsonValue::Value {
  nlohmann::ordered_json json;
};

namespace {

using OrderedJson = nlohmann::ordered_json;

std::string plain_text(const OrderedJson& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    char text[32];
    // Rounds numbers to the precision of float32. Shows millimetres even at distances of thousands of kilometres.
    const double number = value.get<double>();
    std::snprintf(text, sizeof text, std::abs(number) < 1e5 ? "%.7g" : "%.11g", number);
    return text;
  }
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, part] : value.items()) {
    if (!text.empty()) text += value.is_object() ? ", " : " ";
    if (value.is_object()) text += key + " ";
    text += plain_text(part);
  }
  return text;
}

}  // namespace

JsonValue::JsonValue() : value_(std::make_unique<Value>()) {}
JsonValue::JsonValue(bool truth) : value_(new Value{truth}) {}
JsonValue::JsonValue(double number) : value_(new Value{number}) {}
JsonValue::JsonValue(std::int64_t number) : value_(new Value{number}) {}
JsonValue::JsonValue(std::uint64_t number) : value_(new Value{number}) {}
JsonValue::JsonValue(std::string_view text) : value_(new Value{text}) {}
JsonValue::JsonValue(const JsonValue& other) : value_(std::make_unique<Value>(*other.value_)) {}
JsonValue::JsonValue(JsonValue&& other) noexcept : value_(std::move(other.value_)) {}
JsonValue& JsonValue::operator=(JsonValue other) noexcept {
  value_ = std::move(other.value_);
  return *this;
}
JsonValue::~JsonValue() = default;

JsonValue JsonValue::list(std::initializer_list<JsonValue> values) {
  JsonValue all;
  all.value_->json = OrderedJson::array();
  for (const JsonValue& value : values) all.add(value);
  return all;
}

JsonValue JsonValue::named(std::initializer_list<Named> values) {
  JsonValue all;
  all.value_->json = OrderedJson::object();
  for (const auto& [name, value] : values) all.put(name, value);
  return all;
}

void JsonValue::put(std::string_view name, JsonValue value) {
  value_->json[std::string(name)] = std::move(value.value_->json);
}

void JsonValue::add(JsonValue value) { value_->json.push_back(std::move(value.value_->json)); }

bool JsonValue::empty() const { return value_->json.empty(); }

std::string JsonValue::json() const {
  return value_->json.dump(2, ' ', true, OrderedJson::error_handler_t::replace) + "\n";
}

std::vector<std::string> JsonValue::lines() const {
  std::vector<std::string> all;
  for (const auto& [key, value] : value_->json.items()) {
    const bool list = value.is_array() && !value.empty() && !value.front().is_number() && !value.front().is_array();
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (!list && key != "metadata") {
      constexpr std::size_t kColumn = 23;
      name.resize(std::max(name.size() + 1, kColumn), ' ');
      all.push_back(name + plain_text(value));
      continue;
    }
    all.push_back(name);
    for (const auto& [inner, part] : value.items())
      all.push_back("  " + (list ? std::string() : inner + ": ") + plain_text(part));
  }
  return all;
}

bool is_json_with(std::string_view text, std::string_view name) {
  const auto json = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
  return json.is_object() && json.contains(name);
}

}  // namespace gs
