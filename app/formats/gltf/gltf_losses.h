#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Returns the properties of a glTF file that no importer keeps, as messages for the user: animations, and the parts of
/// materials that VRML97 lacks. Safe for untrusted bytes.
[[nodiscard]] std::vector<std::string> gltf_losses(std::span<const std::byte> bytes);

}  // namespace gs::app
