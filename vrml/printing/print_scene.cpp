#include "vrml/printing/print_scene.h"

#include "vrml/printing/classic_printer.h"
#include "vrml/printing/json_printer.h"
#include "vrml/printing/xml_printer.h"

namespace gs::vrml {

Grammar own_grammar(const SceneGraph& scene) {
  return scene.language() == Language::x3d ? Grammar::x3d_classic : Grammar::vrml97;
}

std::vector<std::string> print_scene(const SceneGraph& scene, const PrintOptions& options,
                                     const std::function<bool(std::string_view)>& write) {
  PrintLosses losses;
  NodeTranslator translator(options.grammar == Grammar::vrml97 ? Language::vrml97 : Language::x3d, options.moved_urls,
                            losses);
  TextOutput output(write);
  const TextHead head = text_head(scene, options.grammar, translator);
  if (options.grammar == Grammar::x3d_xml)
    XmlPrinter(scene, translator, output).print(head);
  else if (options.grammar == Grammar::x3d_json)
    JsonPrinter(scene, translator, output).print(head);
  else
    ClassicPrinter(scene, translator, output).print(head);
  return losses.messages();
}

std::string printed_scene(const SceneGraph& scene, const PrintOptions& options) {
  std::string text;
  print_scene(scene, options, [&](std::string_view piece) {
    text += piece;
    return true;
  });
  return text;
}

}  // namespace gs::vrml
