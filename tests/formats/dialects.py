"""Small files as text."""

ROWS = "0 1 2 10 20 30 40 50 60\n0 1 3 11 21 31 41 51 61\n0 1 4 12 22 32 42 52 62\n"

BVH = f"""HIERARCHY
ROOT Hips
{{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg #1
  {{
    OFFSET 5 -2 0
    CHANNELS 3 Xrotation Yrotation Zrotation
    End Site #5
    {{
      OFFSET 0 -40 0
    }}
  }}
}}
MOTION
Frames: 3
Frame Time: .0083333
{ROWS}"""

ASF = """:version 1.10
:name test
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 7
     axis 0 0 20 XYZ
     dof rx ry rz
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 6
     axis 90 0 20 XYZ
     dof rx
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""

AMC = """:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
thigh 5 6 7
shin 8
2
root 1 2 4 11 21 31
thigh 5 6 8
shin 9
"""
