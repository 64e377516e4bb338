#include "app/formats/streamed_names.h"

#include "app/formats/content_types.h"

namespace gs::app {

bool can_be_encoded(std::string_view name) {
  const ContentType* type = content_type_by_name(name);
  return type && type->content != ContentClass::stream;
}

std::string streamed_name(const std::string& name) {
  const ContentType* type = content_type_by_name(name);
  return type && type->content != ContentClass::vrml && can_be_encoded(name) ? name + std::string(kStreamExtension)
                                                                             : name;
}

}  // namespace gs::app
