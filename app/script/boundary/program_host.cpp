#include "app/script/boundary/program_host.h"

#include <string_view>
#include <unordered_set>

namespace gs::app::script {

bool is_own_field_of_script(vrml::Language language, const vrml::InterfaceDeclaration& declaration) {
  static const std::unordered_set<std::string_view> own = {"url", "directOutput", "mustEvaluate"};
  // Programs of X3D 3 may declare fields `description` and `metadata` of their own.
  static const std::unordered_set<std::string_view> own_in_x3d = {"url",  "directOutput", "mustEvaluate",
                                                                  "load", "autoRefresh",  "autoRefreshTimeLimit"};
  constexpr int kSlots = 8;  // of an X3D Script without fields of its own
  if (language == vrml::Language::vrml97)
    return declaration.slot >= 0 && declaration.slot < 3 && own.contains(declaration.name);
  return declaration.slot >= 0 && declaration.slot < kSlots && own_in_x3d.contains(declaration.name);
}

}  // namespace gs::app::script
