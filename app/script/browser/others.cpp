#include "app/script/browser/browser_natives.h"

#include <utility>

// Methods of the Browser object for time, files and options, and those without effect.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxOptions = 64, kMaxOptionText = 256;  // options of a library; characters of a name or value

// Returns the folder of a URL, with the slash at its end.
std::string folder_of(const std::string& url) {
  const std::string path = url.substr(0, url.find_first_of("?#"));
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
}

}  // namespace

bool get_start_time(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::DoubleValue(world_of(context).view().browser().start_time));
  return true;
}

bool get_world_base_url(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, folder_of(world_of(context).view().browser().world_url),
                     JS::CallArgsFromVp(argc, vp).rval());
}

bool get_base_url(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, folder_of(world_of(context).view().browser().base_url),
                     JS::CallArgsFromVp(argc, vp).rval());
}

bool get_option(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string name;
  if (!cut_text_of_value(context, args.get(0), kMaxOptionText, name)) return false;
  const auto& options = library_of(context).options;
  const auto found = options.find(name);
  return make_string(context, found == options.end() ? std::string() : found->second, args.rval());
}

bool set_option(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string name, value;
  if (!cut_text_of_value(context, args.get(0), kMaxOptionText, name) ||
      !cut_text_of_value(context, args.get(1), kMaxOptionText, value))
    return false;
  auto& options = library_of(context).options;
  const bool fits = options.size() < kMaxOptions || options.contains(name);
  if (fits) options[name] = std::move(value);
  args.rval().setBoolean(fits);
  return true;
}

bool get_script(JSContext* context, unsigned argc, JS::Value* vp) {
  return node_to_value(context, world_of(context).calls().running().facts->node, JS::CallArgsFromVp(argc, vp).rval());
}

bool get_imported_node(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{Ask::imported_node};
  args.rval().setNull();
  if (!text_of_value(context, args.get(0), question.text)) return false;
  return node_to_value(context, world_of(context).view().ask(question).node, args.rval());
}

bool do_nothing(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setUndefined();
  return true;
}
bool give_false(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setBoolean(false);
  return true;
}
bool give_zero(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setInt32(0);
  return true;
}
bool give_empty(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, "", JS::CallArgsFromVp(argc, vp).rval());
}

}  // namespace gs::app::script
