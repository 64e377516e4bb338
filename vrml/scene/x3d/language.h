#pragma once

#include <cstdint>

namespace gs::vrml {

/// Language of a text: it selects the node types and their field names. VRML 1.0 and Inventor are converted to VRML97.
enum class Language : std::uint8_t { vrml97, x3d };

/// Encoding of a text, which selects its reader (vrml/syntax/scene_reader.h).
enum class Grammar : std::uint8_t { vrml97, x3d_classic, x3d_xml, x3d_json, inventor };

}  // namespace gs::vrml
