// The formats of other programs, one a file beside this header: each says there where its conventions come from.
#pragma once
#include "capture/formats/foreign.h"

namespace relamp {

extern const ForeignReader metashapeReader;       ///< metashape.cpp: cameras.xml
extern const ForeignReader meshroomReader;        ///< meshroom.cpp: cameras.sfm
extern const ForeignReader realityCaptureReader;  ///< reality_capture.cpp: Internal/External camera parameters, CSV
extern const ForeignReader bundlerReader;         ///< bundler.cpp: bundle.out and list.txt
extern const ForeignReader openMvgReader;         ///< open_mvg.cpp: sfm_data.json
extern const ForeignReader nvmReader;             ///< nvm.cpp: VisualSFM's NVM_V3
extern const ForeignReader llffReader;            ///< llff.cpp: poses_bounds.npy
extern const ForeignReader polycamReader;         ///< phone.cpp: keyframes/corrected_cameras
extern const ForeignReader record3dReader;        ///< phone.cpp: metadata.json of an EXR and JPEG export
extern const ForeignReader scannerAppReader;      ///< phone.cpp: frame_00000.json of 3D Scanner App

}  // namespace relamp
