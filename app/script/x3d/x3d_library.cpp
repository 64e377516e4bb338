#include "app/script/x3d/x3d_natives.h"

#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/SourceText.h>

// Library of X3D programs: the library of VRML97, and the objects of ISO/IEC 19777-1.
namespace gs::app::script {

bool define_x3d(JSContext* context, JS::HandleObject library) {
  if (!define_x3d_natives(context, library)) return false;
  const std::string_view text = x3d_library_text();
  JS::CompileOptions options(context);
  options.setFileAndLine("x3d_library", 1);
  JS::SourceText<mozilla::Utf8Unit> source;
  JS::RootedValue ignored(context);
  return source.init(context, text.data(), text.size(), JS::SourceOwnership::Borrowed) &&
         JS::Evaluate(context, options, source, &ignored);
}

}  // namespace gs::app::script
