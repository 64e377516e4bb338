#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/event_model/states.h"
#include "vrml/scene/node_type.h"

namespace gs::vrml {

// Functions that the behaviours of humanoids (X3D component HAnim) share.

/// Sets an exposedField of any node and sends its value. Does nothing if it was sent with this timestamp.
void set_field(Execution& execution, EventNode node, const InterfaceDeclaration& field, FieldValue value);

/// Connects an HAnimMotion to the joints of its humanoid, by their names.
void attach_motion(Execution& execution, EventNode motion, EventNode humanoid, std::size_t number,
                   const HumanoidState& skeleton);

}  // namespace gs::vrml
