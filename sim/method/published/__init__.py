"""The published method (Uchida, Uno, Yoshida, iSpaRo 2024): detumble by absorbed touches, then cage."""
