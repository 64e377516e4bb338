#pragma once

#include "app/insitu/include/ghostspace/insitu.h"
#include "base/json_value.h"

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app::insitu {

/// Parameter that viewers may change.
struct Parameter {
  std::string name, label, unit;
  double minimum = 0, maximum = 1;
  double value = 0;   // current value in the simulation
  double wanted = 0;  // value from the next agreement of the ranks on
  bool integer = false;
};

/// Parameters of a simulation, and the field that viewers chose. Any thread may read them and set wanted values. The
/// simulation's thread makes wanted values current between steps.
class Parameters {
 public:
  static constexpr std::size_t kMaxParameters = 64;

  /// Adds a parameter. Returns nullopt on success, else the problem.
  [[nodiscard]] std::optional<std::string> add(const gs_insitu_parameter& parameter);
  /// Returns the current value of a parameter, or nullopt.
  [[nodiscard]] std::optional<double> value(std::string_view name) const;
  [[nodiscard]] std::size_t size() const;
  /// Makes the wanted values current. Returns them in the order of the parameters.
  std::vector<double> take_wanted();
  /// Sets all current values, in the order of the parameters.
  void set(const std::vector<double>& values);

  /// Sets wanted values from a query such as "diffusion=0.5&field=heat". On failure, changes nothing and returns the
  /// problem. Safe for untrusted texts.
  [[nodiscard]] std::optional<std::string> set_wanted(std::string_view query);
  /// Sets the fields that viewers can choose.
  void set_fields(std::vector<std::string> fields, const std::string& shown);
  /// Returns the field that viewers chose; empty if they chose none.
  [[nodiscard]] std::string field() const;
  /// Adds the members "parameters", "fields" and "field" to a JSON object.
  void describe(JsonValue& json) const;

 private:
  mutable std::mutex mutex_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> fields_;
  std::string field_, shown_;
};

}  // namespace gs::app::insitu
