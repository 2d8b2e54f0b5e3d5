#include "load_curve.h"
