#include "app/base/fact.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gs::app {

struct Fact::Value {
  nlohmann::ordered_json json;
};

namespace {

using OrderedJson = nlohmann::ordered_json;

std::string plain_text(const OrderedJson& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    char text[32];
    // Uses the precision of float32, but shows millimetres at distances of thousands of kilometres.
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

Fact::Fact() : value_(std::make_unique<Value>()) {}
Fact::Fact(bool truth) : value_(new Value{truth}) {}
Fact::Fact(double number) : value_(new Value{number}) {}
Fact::Fact(std::int64_t number) : value_(new Value{number}) {}
Fact::Fact(std::uint64_t number) : value_(new Value{number}) {}
Fact::Fact(std::string_view text) : value_(new Value{text}) {}
Fact::Fact(const Fact& other) : value_(std::make_unique<Value>(*other.value_)) {}
Fact::Fact(Fact&& other) noexcept : value_(std::move(other.value_)) {}
Fact& Fact::operator=(Fact other) noexcept {
  value_ = std::move(other.value_);
  return *this;
}
Fact::~Fact() = default;

Fact Fact::list(std::initializer_list<Fact> values) {
  Fact all;
  all.value_->json = OrderedJson::array();
  for (const Fact& value : values) all.add(value);
  return all;
}

Fact Fact::named(std::initializer_list<Named> values) {
  Fact all;
  all.value_->json = OrderedJson::object();
  for (const auto& [name, value] : values) all.put(name, value);
  return all;
}

void Fact::put(std::string_view name, Fact value) { value_->json[std::string(name)] = std::move(value.value_->json); }

void Fact::add(Fact value) { value_->json.push_back(std::move(value.value_->json)); }

bool Fact::empty() const { return value_->json.empty(); }

std::string Fact::json() const { return value_->json.dump(2, ' ', true, OrderedJson::error_handler_t::replace) + "\n"; }

std::vector<std::string> Fact::lines() const {
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

}  // namespace gs::app
