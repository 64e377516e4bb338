#include "app/loading/updates/limit_report.h"

#include <string>

namespace gs::app {

void report_limits(const render::RenderList& list, Diagnostics& diagnostics) {
  for (const render::LimitReport& part : list.limit_reports) {
    const std::string others =
        part.count > 1 ? "; left out (and " + std::to_string(part.count - 1) + " more)" : "; left out";
    diagnostics.add({Severity::error, part.file, part.location, part.why + others});
  }
}

}  // namespace gs::app
