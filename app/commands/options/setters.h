#pragma once

#include "app/commands/common/option_groups.h"

#include <optional>
#include <string>

/// Setters for the table of options. Each one sets a member of an option group, or of the struct of one command.
namespace gs::app {

/// Expected form of a value that is wrong; nullopt if the value is right.
using Problem = std::optional<std::string>;

template <class Group>
Group group_of_setter(Problem (*)(Group&, const std::string&));
template <class Group, class Value>
Group group_of_member(Value Group::*);

/// Calls `setter` with the option group that it belongs to. `options` must contain this group.
template <auto setter>
Problem with(CommandOptions& options, const std::string& value) {
  using Group = decltype(group_of_setter(+setter));
  return setter(dynamic_cast<Group&>(options), value);
}

/// Returns the member of the option group that it belongs to. `options` must contain this group.
template <auto member>
auto& member_of(CommandOptions& options) {
  return dynamic_cast<decltype(group_of_member(member))&>(options).*member;
}

template <auto member>
Problem flag(CommandOptions& options, const std::string&) {
  member_of<member>(options) = true;
  return {};
}

template <auto member>
Problem text(CommandOptions& options, const std::string& value) {
  member_of<member>(options) = value;
  return {};
}

/// Sets a path. The path must not be empty.
template <auto member>
Problem file(CommandOptions& options, const std::string& value) {
  member_of<member>(options) = value;
  return value.empty() ? Problem("expected a file") : Problem{};
}

}  // namespace gs::app
