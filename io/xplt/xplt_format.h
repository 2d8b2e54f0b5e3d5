// io/xplt/xplt_format.h – chunk ids of the plot file, shared by the writer and the reader.
// Two ids look like slips (0x0103.... among 0x0104....); they are what FEBio and its viewers use.
#pragma once
#include <cstdint>

namespace dea::xplt {

inline constexpr std::uint32_t kMagic = 0x00464542;
inline constexpr std::uint32_t kOldestVersion = 0x30, kNewestVersion = 0x35;  // known
inline constexpr std::uint32_t kLastVersion = 0x3F;  // of format 3.x: newer files are read as far as they are known
inline constexpr int kFixedName = 64;                // bytes of a fixed-length name, at least one of them zero
inline constexpr int kLongestName = 63;
inline constexpr int kLargestFacet = 10;  // slots of a face record that FEBio's viewer has room for

enum Id : std::uint32_t {
  kRoot = 0x01000000,
  kHeader = 0x01010000,
  kVersionTag = 0x01010001,
  kNodeCountV1 = 0x01010002,
  kMaxFacetV1 = 0x01010003,
  kCompression = 0x01010004,
  kAuthor = 0x01010005,
  kSoftware = 0x01010006,
  kUnits = 0x01010007,

  kDictionary = 0x01020000,
  kItem = 0x01020001,
  kItemType = 0x01020002,
  kItemFormat = 0x01020003,
  kItemName = 0x01020004,
  kItemArraySize = 0x01020005,
  kItemArrayName = 0x01020006,
  kItemUnits = 0x01020007,
  kGlobalItems = 0x01021000,
  kNodalItems = 0x01023000,
  kDomainItems = 0x01024000,
  kSurfaceItems = 0x01025000,
  kEdgeItems = 0x01026000,

  kMesh = 0x01040000,
  kNodes = 0x01041000,
  kNodeHeader = 0x01041100,
  kNodeCount = 0x01041101,
  kNodeDimension = 0x01041102,
  kNodeName = 0x01041103,
  kNodeCoordinates = 0x01041200,
  kDomains = 0x01042000,
  kDomain = 0x01042100,
  kDomainHeader = 0x01042101,
  kDomainType = 0x01042102,
  kDomainPart = 0x01042103,
  kDomainElements = 0x01032104,
  kDomainName = 0x01032105,
  kElementList = 0x01042200,
  kElement = 0x01042201,
  kParts = 0x01045000,
  kPart = 0x01045100,
  kPartId = 0x01045101,
  kPartName = 0x01045102,

  kObjects = 0x01050000,
  kPointObject = 0x01051000,
  kPointCoordinate = 0x01051001,
  kLineObject = 0x01052000,
  kLineEnds = 0x01052001,
  kObjectId = 0x01050001,
  kObjectName = 0x01050002,
  kObjectTag = 0x01050003,
  kObjectPosition = 0x01050004,
  kObjectRotation = 0x01050005,
  kObjectData = 0x01050006,

  kState = 0x02000000,
  kStateHeader = 0x02010000,
  kStateTime = 0x02010002,
  kStateStatus = 0x02010003,
  kStateData = 0x02020000,
  kStateVariable = 0x02020001,
  kStateVariableId = 0x02020002,
  kStateVariableData = 0x02020003,
  kGlobalData = 0x02020100,
  kNodalData = 0x02020300,
  kDomainData = 0x02020400,
  kSurfaceData = 0x02020500,
  kEdgeData = 0x02020600,
  kMeshState = 0x02030000,
  kElementFlags = 0x02030001,
  kObjectStates = 0x02040000,
};

/// Surfaces, facet sets and edges are stored alike, under different ids; node sets and element sets, too, without what
/// is of facets.
struct ListIds {
  std::uint32_t section, one, header, id, count, name, list, max_nodes = 0, facet = 0;
};
inline constexpr ListIds kSurfaceIds = {0x01043000, 0x01043100, 0x01043101, 0x01043102, 0x01043103,
                                        0x01043104, 0x01043200, 0x01043105, 0x01043201};
inline constexpr ListIds kFacetSetIds = {0x01047000, 0x01047100, 0x01047101, 0x01047102, 0x01047104,
                                         0x01047103, 0x01047200, 0x01047105, 0x01047201};
inline constexpr ListIds kEdgeIds = {0x01048000, 0x01048100, 0x01048101, 0x01048102, 0x01048103,
                                     0x01048104, 0x01048200, 0x01048105, 0x01048201};
inline constexpr ListIds kNodeSetIds = {0x01044000, 0x01044100, 0x01044101, 0x01044102,
                                        0x01044104, 0x01044103, 0x01044200};
inline constexpr ListIds kElementSetIds = {0x01046000, 0x01046100, 0x01046101, 0x01046102,
                                           0x01046104, 0x01046103, 0x01046200};

/// In the order of XpltGroup.
inline constexpr int kGroups = 5;
inline constexpr std::uint32_t kGroupItems[kGroups] = {kGlobalItems, kNodalItems, kDomainItems, kSurfaceItems,
                                                       kEdgeItems};
inline constexpr std::uint32_t kGroupData[kGroups] = {kGlobalData, kNodalData, kDomainData, kSurfaceData, kEdgeData};

}  // namespace dea::xplt
