#include "app/formats/datasets/conventions/xdmf_tree.h"

#include "base/text.h"

#include <algorithm>
#include <type_traits>

#include <expat.h>

namespace gs::app {
namespace {

constexpr std::size_t kMostElements = 500'000, kMostDepth = 64, kMostText = std::size_t{256} << 20;

struct XdmfParse {
  XML_Parser parser = nullptr;
  std::unique_ptr<XdmfElement> root;
  XdmfElement* open = nullptr;
  std::size_t elements = 0, depth = 0, text = 0;
  const char* refusal = nullptr;

  void refuse(const char* why) {
    refusal = why;
    (void)XML_StopParser(parser, XML_FALSE);
  }
};

std::string local_name(const char* name) {
  const std::string_view text(name);
  const std::size_t colon = text.rfind(':');
  return std::string(colon == std::string_view::npos ? text : text.substr(colon + 1));
}

void begin_xdmf_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  auto& parse = *static_cast<XdmfParse*>(user);
  if (++parse.elements > kMostElements || ++parse.depth > kMostDepth)
    return parse.refuse("too many or too deep elements");
  auto made = std::make_unique<XdmfElement>();
  made->name = local_name(name);
  for (; *attributes; attributes += 2) made->attributes.emplace_back(local_name(attributes[0]), attributes[1]);
  made->parent = parse.open;
  XdmfElement* const raw = made.get();
  if (parse.open)
    parse.open->children.push_back(std::move(made));
  else
    parse.root = std::move(made);
  parse.open = raw;
}

void end_xdmf_element(void* user, const XML_Char*) {
  auto& parse = *static_cast<XdmfParse*>(user);
  --parse.depth;
  if (parse.open) parse.open = parse.open->parent;
}

void take_xdmf_text(void* user, const XML_Char* text, int length) {
  auto& parse = *static_cast<XdmfParse*>(user);
  parse.text += static_cast<std::size_t>(length);
  if (parse.text > kMostText) return parse.refuse("too much text");
  if (parse.open) parse.open->text.append(text, static_cast<std::size_t>(length));
}

const XdmfElement* grid_named(const XdmfElement& element, const std::string& name, bool any_grid) {
  if (element.name == "Grid" && (any_grid ? element.child("Topology") != nullptr : element.attribute("Name") == name))
    return &element;
  for (const auto& child : element.children)
    if (const XdmfElement* const found = grid_named(*child, name, any_grid)) return found;
  return nullptr;
}

}  // namespace

std::string XdmfElement::attribute(std::string_view attribute_name) const {
  for (const auto& [key, value] : attributes)
    if (lower_case(key) == lower_case(attribute_name)) return value;
  return {};
}

const XdmfElement* XdmfElement::child(std::string_view child_name) const {
  for (const auto& one : children)
    if (one->name == child_name) return one.get();
  return nullptr;
}

std::variant<std::unique_ptr<XdmfElement>, std::string> parse_xdmf(std::span<const std::byte> bytes,
                                                                   std::string_view root) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                                             XML_ParserFree);
  if (!parser) return std::string("no memory for its text");
  XdmfParse parse;
  parse.parser = parser.get();
  XML_SetUserData(parser.get(), &parse);
  XML_SetElementHandler(parser.get(), begin_xdmf_element, end_xdmf_element);
  XML_SetCharacterDataHandler(parser.get(), take_xdmf_text);
  constexpr std::size_t kPiece = std::size_t{1} << 24;
  for (std::size_t at = 0; at < bytes.size() || at == 0; at += kPiece) {
    const auto piece = bytes.subspan(at, std::min(kPiece, bytes.size() - at));
    const bool last = at + piece.size() == bytes.size();
    if (XML_Parse(parser.get(), reinterpret_cast<const char*>(piece.data()), static_cast<int>(piece.size()), last) !=
        XML_STATUS_ERROR)
      continue;
    return "line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " +
           (parse.refusal ? parse.refusal : XML_ErrorString(XML_GetErrorCode(parser.get())));
  }
  if (!parse.root || parse.root->name != root) return "the first element is not " + std::string(root);
  return std::move(parse.root);
}

std::vector<const XdmfElement*> xdmf_children(const XdmfElement& root, const XdmfElement& grid) {
  std::vector<const XdmfElement*> all;
  for (const auto& child : grid.children) {
    if (child->name != "include") {
      all.push_back(child.get());
      continue;
    }
    const std::string pointer = child->attribute("xpointer");
    const std::size_t begin = pointer.find('"'), end = pointer.rfind('"');
    const bool named = pointer.find("@Name") != std::string::npos && begin != std::string::npos && end > begin;
    const XdmfElement* const source = grid_named(root, named ? pointer.substr(begin + 1, end - begin - 1) : "", !named);
    if (!source) continue;
    for (const auto& part : source->children)
      if ((part->name == "Topology" || part->name == "Geometry") && &grid != source) all.push_back(part.get());
  }
  return all;
}

}  // namespace gs::app
