#include "app/loading/updates/missing_url.h"

namespace gs::app {

std::string why_missing(const vrml::MFString& urls, const std::string& why) {
  if (urls.empty()) return "has no url";
  std::string text = "cannot find '" + std::string(urls.front().view().substr(0, 200)) + "'";
  if (urls.size() > 1) text += " or the " + std::to_string(urls.size() - 1) + " others of its url list";
  return why.empty() ? text : text + " (" + why.substr(0, 300) + ")";
}

}  // namespace gs::app
