#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/script_world.h"

#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <algorithm>
#include <cmath>

// SFImage (VRML97 C.6.5).
namespace gs::app::script {
namespace {

enum : std::uint32_t { kWidth, kHeight, kComponents, kArray, kParent, kPlace, kSlots };

const JSClass kImageClass = {"SFImage", JSCLASS_HAS_RESERVED_SLOTS(kSlots), nullptr, nullptr, nullptr, nullptr};

bool changed(JSContext* context, JS::HandleObject image) {
  const JS::Value parent = JS::GetReservedSlot(image, kParent);
  if (!parent.isObject()) return true;
  JS::RootedObject source(context, &parent.toObject());
  JS::RootedValue value(context, JS::ObjectValue(*image));
  return write_back(context, source, static_cast<std::uint32_t>(JS::GetReservedSlot(image, kPlace).toInt32()), value);
}

/// Calls `use` with the arguments and the SFImage that a function was called on.
template <class Use>
bool with_image(JSContext* context, unsigned argc, JS::Value* vp, Use use) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (!args.thisv().isObject() || !is_image(&args.thisv().toObject()))
    return fail(context, "called on a value that is not an SFImage");
  const JS::RootedObject image(context, &args.thisv().toObject());
  return use(args, image);
}

template <std::uint32_t kSlot>
bool get_part(JSContext* context, unsigned argc, JS::Value* vp) {
  return with_image(context, argc, vp, [](const JS::CallArgs& args, JS::HandleObject image) {
    args.rval().set(JS::GetReservedSlot(image, kSlot));
    return true;
  });
}

bool set_array(JSContext* context, JS::HandleObject image, JS::HandleValue value) {
  vrml::FieldValue numbers;
  if (!to_field(context, value, vrml::FieldType::MFInt32, 0, numbers)) return false;
  ListBox box;
  box.value = std::move(numbers);
  // A later assignment to an element of this list changes the image.
  JSObject* const list = make_list(context, std::move(box), {image, 0});
  if (!list) return false;
  JS::SetReservedSlot(image, kArray, JS::ObjectValue(*list));
  return true;
}

template <std::uint32_t kSlot>
bool set_part(JSContext* context, unsigned argc, JS::Value* vp) {
  return with_image(context, argc, vp, [context](const JS::CallArgs& args, JS::HandleObject image) {
    args.rval().setUndefined();
    if constexpr (kSlot == kArray) {
      if (!set_array(context, image, args.get(0))) return false;
    } else {
      double number = 0;
      if (!JS::ToNumber(context, args.get(0), &number)) return false;
      JS::SetReservedSlot(image, kSlot, JS::Int32Value(JS::ToInt32(number)));
    }
    return changed(context, image);
  });
}

bool construct_image(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedObject image(context, make_image(context, {}, {}));
  if (!image) return false;
  for (unsigned i = 0; i < 3 && i < args.length(); ++i) {
    double number = 0;
    if (!JS::ToNumber(context, args[i], &number)) return false;
    JS::SetReservedSlot(image, i, JS::Int32Value(JS::ToInt32(number)));
  }
  if (args.length() > 3 && !set_array(context, image, args[3])) return false;
  args.rval().setObject(*image);
  return true;
}

bool image_to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  return with_image(context, argc, vp, [context](const JS::CallArgs& args, JS::HandleObject image) {
    vrml::PixelImage value;
    if (!image_of(context, image, value)) return false;
    std::string text;
    for (std::size_t i = 0; i < std::max<std::size_t>(3, value.words.size()); ++i)
      text += (i ? " " : "") + std::to_string(i < value.words.size() ? value.words[i] : 0);
    return make_string(context, text, args.rval());
  });
}

const JSPropertySpec kParts[] = {
    JS_PSGS("x", contained<get_part<kWidth>>, contained<set_part<kWidth>>, kProperty),
    JS_PSGS("y", contained<get_part<kHeight>>, contained<set_part<kHeight>>, kProperty),
    JS_PSGS("comp", contained<get_part<kComponents>>, contained<set_part<kComponents>>, kProperty),
    JS_PSGS("array", contained<get_part<kArray>>, contained<set_part<kArray>>, kProperty),
    JS_PSGS("width", contained<get_part<kWidth>>, contained<set_part<kWidth>>, kProperty),
    JS_PSGS("height", contained<get_part<kHeight>>, contained<set_part<kHeight>>, kProperty),
    JS_PS_END};
const JSFunctionSpec kImageMethods[] = {JS_FN("toString", contained<image_to_text>, 0, 0), JS_FS_END};

}  // namespace

bool define_images(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes) {
  JS::RootedObject prototype(context, JS_InitClass(context, library, nullptr, &kImageClass, construct_image, 4, kParts,
                                                   kImageMethods, nullptr, nullptr));
  if (!prototype) return false;
  prototypes[static_cast<std::size_t>(vrml::FieldType::SFImage)] = prototype;
  return true;
}

bool is_image(JSObject* object) { return JS::GetClass(object) == &kImageClass; }

JSObject* make_image(JSContext* context, const vrml::PixelImage& image, Source source) {
  JS::RootedObject parent(context, source.parent);
  JS::RootedObject prototype(context, library_of(context).prototype(vrml::FieldType::SFImage));
  JS::RootedObject made(context, JS_NewObjectWithGivenProto(context, &kImageClass, prototype));
  if (!made) return nullptr;
  JS::SetReservedSlot(made, kWidth, JS::Int32Value(static_cast<std::int32_t>(image.width())));
  JS::SetReservedSlot(made, kHeight, JS::Int32Value(static_cast<std::int32_t>(image.height())));
  JS::SetReservedSlot(made, kComponents, JS::Int32Value(static_cast<std::int32_t>(image.components())));
  JS::SetReservedSlot(made, kParent, parent ? JS::ObjectValue(*parent) : JS::UndefinedValue());
  JS::SetReservedSlot(made, kPlace, JS::Int32Value(static_cast<std::int32_t>(source.place)));
  vrml::MFInt32 numbers;
  for (const std::uint32_t pixel : image.pixels()) numbers.push_back(static_cast<std::int32_t>(pixel));
  ListBox box;
  box.value = std::move(numbers);
  JSObject* const list = make_list(context, std::move(box), {made, 0});
  if (!list) return nullptr;
  JS::SetReservedSlot(made, kArray, JS::ObjectValue(*list));
  return made;
}

// Converts an SFImage object. The number of pixels is width times height; missing pixels are 0.
bool image_of(JSContext* context, JS::HandleObject object, vrml::PixelImage& image) {
  const auto number = [&](std::uint32_t slot) {
    const JS::Value value = JS::GetReservedSlot(object, slot);
    return value.isInt32() ? value.toInt32() : 0;
  };
  const std::int64_t width = number(kWidth), height = number(kHeight), components = number(kComponents);
  image.words.clear();
  if (width <= 0 || height <= 0 || components <= 0) return true;
  const std::size_t most = world_of(context).calls().image_pixels();
  if (components > 4 || static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > most ||
      !world_of(context).engine().may_have(static_cast<std::size_t>(width * height) * 4))
    return fail(context, "an SFImage of this size cannot be created");
  const JS::Value array = JS::GetReservedSlot(object, kArray);
  vrml::MFInt32 pixels;
  if (array.isObject())
    if (ListBox* const list = list_of(&array.toObject()))
      if (const vrml::FieldValue* const value = list_value(*list)) pixels = std::get<vrml::MFInt32>(*value);
  image.words.resize(static_cast<std::size_t>(3 + width * height));
  std::uint32_t* const words = image.words.mutable_data();
  words[0] = static_cast<std::uint32_t>(width);
  words[1] = static_cast<std::uint32_t>(height);
  words[2] = static_cast<std::uint32_t>(components);
  for (std::size_t i = 3; i < image.words.size(); ++i)
    words[i] = i - 3 < pixels.size() ? static_cast<std::uint32_t>(pixels[i - 3]) : 0;
  return true;
}

bool image_array_changed(JSContext* context, JS::HandleObject image) { return changed(context, image); }

}  // namespace gs::app::script
