#pragma once

#include <cstdint>

namespace gs::vrml {

/// Language of a text. It selects the node types and the rules.
enum class Language : std::uint8_t { vrml97, x3d };

}  // namespace gs::vrml
