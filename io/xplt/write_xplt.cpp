#include "xplt.h"
