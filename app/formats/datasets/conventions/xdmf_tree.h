#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

/// Element of an XML file, with its text.
struct XdmfElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;
  std::vector<std::unique_ptr<XdmfElement>> children;
  XdmfElement* parent = nullptr;

  /// Returns an attribute; the case of its name is ignored. Returns an empty text without it.
  [[nodiscard]] std::string attribute(std::string_view attribute_name) const;
  /// Returns the first child with this name, or null.
  [[nodiscard]] const XdmfElement* child(std::string_view child_name) const;
};

/// Parses XML of limited depth and size without external entities. `root` is the name of its first element. Returns a
/// message with the line on failure.
[[nodiscard]] std::variant<std::unique_ptr<XdmfElement>, std::string> parse_xdmf(std::span<const std::byte> bytes,
                                                                                 std::string_view root = "Xdmf");

/// Includes of other parts of the file (xi:include with an xpointer that names a Grid) become copies of references:
/// returns the children of `grid` with those that it includes.
[[nodiscard]] std::vector<const XdmfElement*> xdmf_children(const XdmfElement& root, const XdmfElement& grid);

}  // namespace gs::app
