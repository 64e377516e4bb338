#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component Sound (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kSoundX3DRows[] = {
    {"AudioClip", "Sound", 1, "source", "X3DSoundSourceNode X3DUrlObject",
     Role::child | Role::time_dependent | Role::sound_source, NodeKind::other, R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFBool     load TRUE
  exposedField SFBool     loop FALSE
  exposedField SFTime     pauseTime 0
  exposedField SFFloat    pitch 1.0  # (0,inf)
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField MFString   url []
  eventOut     SFTime     duration_changed  # [-1,inf)
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)"},
    {"ListenerPointSource",
     "Sound",
     2,
     "children",
     "X3DSoundSourceNode",
     Role::child | Role::time_dependent | Role::sound_source,
     NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFBool     dopplerEnabled FALSE
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFFloat    interauralDistance 0  # [0,inf)
  exposedField SFRotation orientation 0 0 1 0
  exposedField SFTime     pauseTime 0
  exposedField SFVec3f    position 0 0 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFBool     trackCurrentView FALSE
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Sound", "Sound", 1, "children", "X3DSoundNode", Role::child, NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFVec3f    direction 0 0 1
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    intensity 1  # [0,1]
  exposedField SFVec3f    location 0 0 0
  exposedField SFFloat    maxBack 10  # [0,inf)
  exposedField SFFloat    maxFront 10  # [0,inf)
  exposedField SFFloat    minBack 1  # [0,inf)
  exposedField SFFloat    minFront 1  # [0,inf)
  exposedField SFFloat    priority 0  # [0,1]
  exposedField SFNode     source NULL  # X3DSoundSourceNode
  field        SFBool     spatialize TRUE
)"},
    {"SpatialSound", "Sound", 2, "children", "X3DSoundNode", Role::child, NodeKind::other, R"(
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFFloat    coneInnerAngle 6.2832  # [0,6.2832]
  exposedField SFFloat    coneOuterAngle 6.2832  # [0,6.2832]
  exposedField SFFloat    coneOuterGain 0
  exposedField SFString   description ""
  exposedField SFVec3f    direction 0 0 1
  exposedField SFString   distanceModel "INVERSE"
  exposedField SFBool     dopplerEnabled FALSE
  exposedField SFBool     enabled TRUE
  exposedField SFBool     enableHRTF FALSE
  exposedField SFFloat    gain 1
  exposedField SFFloat    intensity 1  # [0,1]
  exposedField SFVec3f    location 0 0 0
  exposedField SFFloat    maxDistance 10000  # [0,inf)
  exposedField SFFloat    priority 0  # [0,1]
  exposedField SFFloat    referenceDistance 1  # [0,inf)
  exposedField SFFloat    rolloffFactor 1  # [0,inf)
  field        SFBool     spatialize TRUE
)"},
};

}  // namespace

std::span<const X3DRow> x3d_sound_rows() { return kSoundX3DRows; }

}  // namespace gs::vrml
