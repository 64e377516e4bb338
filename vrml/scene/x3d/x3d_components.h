#pragma once

#include <string_view>

namespace gs::vrml {

/// Component of X3D (ISO/IEC 19775-1, clauses 7 to 43).
struct X3DComponent {
  std::string_view name;
  int levels = 1;     // levels in the standard
  int supported = 1;  // highest supported level; 0 if the component is not supported
};

/// Profile of X3D (ISO/IEC 19775-1, annexes A to H).
struct X3DProfile {
  std::string_view name;
  std::string_view missing;  // components that are not supported; empty if the profile is supported in full
};

/// Returns the component with this name; null if there is none.
[[nodiscard]] const X3DComponent* x3d_component_named(std::string_view name);
/// Returns the profile with this name; null if there is none.
[[nodiscard]] const X3DProfile* x3d_profile_named(std::string_view name);

}  // namespace gs::vrml
