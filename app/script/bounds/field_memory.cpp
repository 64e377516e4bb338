#include "app/script/bounds/field_memory.h"

#include <type_traits>
#include <variant>

namespace gs::app::script {

std::size_t block_bytes_of(const vrml::FieldValue& value) {
  return std::visit(
      [](const auto& array) -> std::size_t {
        if constexpr (requires { array.span(); }) return array.capacity() * sizeof(*array.data());
        if constexpr (requires { typename std::decay_t<decltype(array)>::element_type; }) return sizeof(*array);
        return 0;
      },
      value);
}

std::size_t text_bytes_of(const vrml::FieldValue& value, std::size_t first) {
  const auto* const texts = std::get_if<vrml::MFString>(&value);
  const auto* const images = std::get_if<vrml::MFImage>(&value);
  std::size_t bytes = 0;
  for (std::size_t i = first; images && i < images->size(); ++i)
    bytes += (*images)[i].words.size() * sizeof(std::uint32_t);
  for (std::size_t i = first; texts && i < texts->size(); ++i) bytes += (*texts)[i].view().size();
  return bytes;
}

std::size_t bytes_of(const vrml::FieldValue& value) {
  if (const auto* const text = std::get_if<vrml::SFString>(&value)) return text->view().size();
  if (const auto* const image = std::get_if<vrml::SFImage>(&value)) return image->words.size() * sizeof(std::uint32_t);
  return block_bytes_of(value) + text_bytes_of(value, 0);
}

}  // namespace gs::app::script
